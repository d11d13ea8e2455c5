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
    std::size_t begin = 0;                            ///< first index
    std::size_t end = 0;                              ///< one past the last index
    std::size_t size() const { return end - begin; }  ///< number of indices
};

/// Runs body(range) over disjoint ranges that cover [0, count), each of length `grain` except the last. The
/// ranges depend only on `count` and `grain`, so that results per range do not depend on the number of
/// threads. With one thread, or one range, this is a plain loop; otherwise it runs on the threads of oneTBB,
/// leaving their number unchanged, or on its own threads if ctx.threads exceeds the number of the machine.
///
/// An exception of the body, including std::bad_alloc, ends the loop early and is rethrown here; of several
/// exceptions, it is undefined which one. Polls for a stop before every range, and throws Cancelled after a
/// request.
void parallel_for_ranges(const Context& ctx, std::size_t count, std::size_t grain,
                         const std::function<void(IndexRange)>& body);

/// Runs body(i) for every i in [0, count).
template <class Body>
void parallel_for(const Context& ctx, std::size_t count, std::size_t grain, const Body& body) {
    parallel_for_ranges(ctx, count, grain, [&](IndexRange range) {
        for (std::size_t i = range.begin; i < range.end; ++i) body(i);
    });
}

/// Runs body(i, context) for every i in [0, count): first the large ones, sequentially with all threads, then
/// the others in parallel, in groups of `grain`, each with one thread. A single one uses all threads. The
/// contexts report no progress.
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
    static_assert(!std::is_same_v<T, bool>,
                  "adjacent elements of a vector of bool share a byte: a data race");
    std::vector<T> part((count + grain - 1) / grain, init);
    parallel_for_ranges(ctx, count, grain, [&](IndexRange range) { part[range.begin / grain] = map(range); });
    for (const T& p : part) init = fold(init, p);
    return init;
}

/// Replaces each count by the sum of all previous counts; returns the total.
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
