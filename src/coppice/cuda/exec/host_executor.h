#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <span>
#include <type_traits>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/base/parallel.h"

namespace coppice::cuda {

/// The threads of one group of a kernel, which wait for each other after every step: on a card those of one
/// block, here one after the other. What a step reads, no other thread of the same step may write.
class HostGroup {
  public:
    /// Runs body(i) for every i below `count`.
    template <class Body>
    COPPICE_HOST_DEVICE void each(std::uint32_t count, const Body& body) const {
        for (std::uint32_t i = 0; i < count; ++i) body(i);
    }
    /// out[k] = the k-th i below `count` for which test(i), ascending; all threads learn how many there are.
    template <class Test>
    COPPICE_HOST_DEVICE std::uint32_t select(std::uint32_t count, const Test& test,
                                             std::uint32_t* out) const {
        std::uint32_t found = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            if (test(i)) out[found++] = i;
        }
        return found;
    }
};

/// Runs kernels on the CPU: what a card would compute, so that every kernel is tested without one. It has the
/// same members as CudaExecutor, so that the stages are written once for both.
///
/// A kernel is a copyable struct with operator()(i), marked COPPICE_HOST_DEVICE, that reads and writes arrays
/// of this executor alone; no two i may write the same place.
class HostExecutor {
  public:
    static constexpr bool kIsDevice = false;  ///< kernels run on the CPU

    /// Runs with the context's threads, and stops with it.
    explicit HostExecutor(const Context& ctx = {}) : ctx_(ctx) {}

    /// Memory for `count` numbers, not set, until reset().
    template <class T>
    std::span<T> array(std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        // Each one of its own, so that a sanitizer sees who reads beyond.
        memory_.push_back(
            std::make_unique_for_overwrite<std::byte[]>(std::max<std::size_t>(1, count) * sizeof(T)));
        return {reinterpret_cast<T*>(memory_.back().get()), count};
    }
    /// A copy of `values`, which may go away.
    template <class T>
    std::span<const T> upload(std::span<const T> values) {
        const std::span<T> out = array<T>(values.size());
        std::copy(values.begin(), values.end(), out.begin());
        return out;
    }
    /// Copies as many values as there are places into an array.
    template <class T>
    void write(std::span<const T> from, std::span<T> to) const {
        std::copy(from.begin(), from.end(), to.begin());
    }
    /// Copies back as many values as there are places. All that was begun has then been done.
    template <class T>
    void download(std::span<const T> from, std::span<T> to) const {
        std::copy(from.begin(), from.end(), to.begin());
    }
    /// Sets all bytes to 0.
    template <class T>
    void clear(std::span<T> values) const {
        std::fill(values.begin(), values.end(), T{});
    }
    /// How many arrays there are.
    using Mark = std::size_t;
    /// See rewind().
    Mark mark() const { return memory_.size(); }
    /// Frees the arrays made since the mark, once all that was begun has been done.
    void rewind(Mark mark) { memory_.resize(mark); }
    /// Frees all arrays.
    void reset() { memory_.clear(); }

    /// Runs kernel(i) for every i below `count`.
    template <class Kernel>
    void each(const char* /*name*/, std::size_t count, const Kernel& kernel) const {
        parallel_for(ctx_, count, 1024, [&](std::size_t i) { kernel(static_cast<std::uint32_t>(i)); });
    }
    /// Runs kernel(i, group) for every i below `count`, each with a group of threads of its own.
    template <class Kernel>
    void groups(const char* /*name*/, std::size_t count, const Kernel& kernel) const {
        parallel_for(ctx_, count, 1,
                     [&](std::size_t i) { kernel(static_cast<std::uint32_t>(i), HostGroup()); });
    }
    /// out[i] = sum of the counts before i. Both have the same size, and may be the same.
    template <class T>
    void exclusive_scan(std::span<const T> counts, std::span<T> out) const {
        std::exclusive_scan(counts.begin(), counts.end(), out.begin(), T{});
    }
    /// Sorts values by their keys, `bits` of which count; what has the same key keeps its order.
    template <class Key>
    void sort_pairs(std::span<Key> keys, std::span<std::uint32_t> values, int bits = 8 * sizeof(Key)) const {
        const Key mask = bits < static_cast<int>(8 * sizeof(Key)) ? (Key{1} << bits) - 1 : ~Key{0};
        std::vector<std::size_t> order(keys.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t i) { return keys[i] & mask; });
        const std::vector<Key> old_keys(keys.begin(), keys.end());
        const std::vector<std::uint32_t> old_values(values.begin(), values.end());
        for (std::size_t i = 0; i < order.size(); ++i) {
            keys[i] = old_keys[order[i]];
            values[i] = old_values[order[i]];
        }
    }
    /// Waits until all that was begun has been done.
    void wait() const {}

  private:
    Context ctx_;
    std::vector<std::unique_ptr<std::byte[]>> memory_;
};

}  // namespace coppice::cuda
