#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <type_traits>
#include <vector>

#include "coppice/base/context.h"

namespace coppice {

/// Half-open range of indices.
struct IndexRange {
    std::size_t begin = 0;                            ///< the first index
    std::size_t end = 0;                              ///< one past the last
    std::size_t size() const { return end - begin; }  ///< number of indices
};

/// Runs body(range) over disjoint ranges that cover [0, count), each `grain` long but for the last. The
/// ranges depend on `count` and `grain` alone, so whatever is computed per range has the same bits for any
/// number of threads. With one thread, or one range, this is a plain loop; else it runs on oneTBB's threads,
/// whose number it leaves alone, and on threads of its own when ctx.threads is more than the machine has.
///
/// What the body throws, be it that memory ran out, ends the loop early and is thrown here; of several, which
/// one is not determined. Before every range it looks for a stop, and throws Cancelled once one was asked
/// for.
void parallel_for_ranges(const Context& ctx, std::size_t count, std::size_t grain,
                         const std::function<void(IndexRange)>& body);

/// Runs body(i) for every i in [0, count).
template <class Body>
void parallel_for(const Context& ctx, std::size_t count, std::size_t grain, const Body& body) {
    parallel_for_ranges(ctx, count, grain, [&](IndexRange range) {
        for (std::size_t i = range.begin; i < range.end; ++i) body(i);
    });
}

/// Runs body(i, context) for every i in [0, count): first the large ones, one after the other with all
/// threads, then the others side by side, `grain` in a row, each with one thread. One alone has all threads.
/// The contexts report no progress.
template <class IsLarge, class Body>
void parallel_for_uneven(const Context& ctx, std::size_t count, std::size_t grain, const IsLarge& is_large,
                         const Body& body) {
    const Context all{.threads = ctx.threads, .stop = ctx.stop}, one{.threads = 1, .stop = ctx.stop};
    std::vector<std::size_t> small;
    for (std::size_t i = 0; i < count; ++i) {
        if (count == 1 || is_large(i)) {
            body(i, all);
        } else {
            small.push_back(i);
        }
    }
    parallel_for(ctx, small.size(), grain, [&](std::size_t k) { body(small[k], one); });
}

/// Folds map(range) of the fixed ranges in index order: deterministic also for floating point.
template <class T, class Map, class Fold>
T parallel_reduce(const Context& ctx, std::size_t count, std::size_t grain, T init, const Map& map,
                  const Fold& fold) {
    static_assert(!std::is_same_v<T, bool>, "neighbours in a vector of bool share their byte: a data race");
    std::vector<T> part((count + grain - 1) / grain, init);
    parallel_for_ranges(ctx, count, grain, [&](IndexRange range) { part[range.begin / grain] = map(range); });
    for (const T& p : part) init = fold(init, p);
    return init;
}

/// Replaces counts by the sum of all counts before each; returns the total.
template <class T>
T exclusive_scan(std::span<T> counts) {
    T sum{};
    for (T& c : counts) {
        const T count = c;
        c = sum;
        sum += count;
    }
    return sum;
}

}  // namespace coppice
