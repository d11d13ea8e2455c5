#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <type_traits>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/base/parallel.h"
#include "coppice/cuda/device.h"

namespace coppice::cuda {

/// The threads of one group of a kernel, which synchronise after every step: the threads of one block on a
/// GPU, sequential here. No thread may write data that another thread of the same step reads.
class HostGroup {
  public:
    /// Runs body(i) for every i below `count`.
    template <class Body>
    COPPICE_HOST_DEVICE void each(std::uint32_t count, const Body& body) const {
        for (std::uint32_t i = 0; i < count; ++i) body(i);
    }
    /// Stores in out[k] the k-th i below `count` that satisfies test(i), ascending; returns their number to
    /// all threads.
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

/// Runs kernels on the CPU, so that every kernel can be tested without a GPU. It has the same members as
/// CudaExecutor, so that the stages are written once for both.
///
/// A kernel is a copyable struct with operator()(i), marked COPPICE_HOST_DEVICE, that accesses only arrays of
/// this executor; no two i may write the same element.
class HostExecutor {
  public:
    static constexpr bool kIsDevice = false;  ///< kernels run on the CPU

    /// Launches that can be repeated: see replay().
    class Recording {
      public:
        void clear() {}  ///< removes the launches
    };

    /// Uses the threads and cancellation of the context. Arrays may use `room` bytes, to simulate the memory
    /// of a GPU.
    explicit HostExecutor(const Context& ctx = {}, std::size_t room = std::numeric_limits<std::size_t>::max())
        : ctx_(ctx), room_(room) {}

    /// [bytes] Returns the maximum size of all arrays together.
    std::size_t room() const { return room_; }
    /// Ensures that this amount of memory is available. Throws DeviceError if there is less.
    void reserve(std::size_t bytes) const { require_room(room_, bytes); }
    /// [bytes] Returns the maximum size of all arrays since reset().
    std::size_t bytes_used() const { return most_; }

    /// Returns uninitialised memory for `count` numbers, valid until reset(). Throws DeviceError if there is
    /// not enough memory.
    template <class T>
    std::span<T> array(std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        constexpr std::size_t kAlignment = 256;  // of arrays on a GPU
        const std::size_t bytes = (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
        require_room(room_, used_ + bytes);
        // Separate allocations, so that a sanitizer detects access out of bounds.
        memory_.push_back(
            {std::make_unique_for_overwrite<std::byte[]>(std::max<std::size_t>(1, count) * sizeof(T)),
             bytes});
        used_ += bytes;
        most_ = std::max(most_, used_);
        return {reinterpret_cast<T*>(memory_.back().begin.get()), count};
    }
    /// Returns a copy of `values`, which need not outlive the call.
    template <class T>
    std::span<const T> upload(std::span<const T> values) {
        const std::span<T> out = array<T>(values.size());
        std::copy(values.begin(), values.end(), out.begin());
        return out;
    }
    /// Copies to.size() values into an array.
    template <class T>
    void write(std::span<const T> from, std::span<T> to) const {
        std::copy(from.begin(), from.end(), to.begin());
    }
    /// Copies to.size() values back, after all previous work has finished.
    template <class T>
    void download(std::span<const T> from, std::span<T> to) const {
        std::copy(from.begin(), from.end(), to.begin());
    }
    /// Copies values without waiting: they are available after wait(), until rewind() or reset().
    template <class T>
    std::span<const T> fetch(std::span<const T> from) {
        return upload(from);
    }
    /// Sets all bytes to 0.
    template <class T>
    void clear(std::span<T> values) const {
        std::fill(values.begin(), values.end(), T{});
    }
    /// Number of arrays.
    using Mark = std::size_t;
    /// See rewind().
    Mark mark() const { return memory_.size(); }
    /// Releases the arrays created since the mark, once all previous work has finished.
    void rewind(Mark mark) {
        while (memory_.size() > mark) {
            used_ -= memory_.back().bytes;
            memory_.pop_back();
        }
    }
    /// Releases all arrays.
    void reset() {
        rewind(0);
        most_ = 0;
    }

    /// Runs kernel(i) for every i below `count`.
    template <class Kernel>
    void each(const char* /*name*/, std::size_t count, const Kernel& kernel) const {
        parallel_for(ctx_, count, 1024, [&](std::size_t i) { kernel(static_cast<std::uint32_t>(i)); });
    }
    /// Runs kernel(i, group) for every i below `count`, each with its own group of threads.
    template <class Kernel>
    void groups(const char* /*name*/, std::size_t count, const Kernel& kernel) const {
        parallel_for(ctx_, count, 1,
                     [&](std::size_t i) { kernel(static_cast<std::uint32_t>(i), HostGroup()); });
    }
    /// Computes out[i] = sum of the counts before i. Both have the same size, and may be the same array.
    template <class T>
    void exclusive_scan(std::span<const T> counts, std::span<T> out) const {
        std::exclusive_scan(counts.begin(), counts.end(), out.begin(), T{});
    }
    /// Sorts values stably by the lowest `bits` of their keys.
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
    /// Executes work(), which must start the same launches on the same arrays in every call, and must not
    /// write, download or wait. A GPU records the launches once and then repeats them with a single call.
    template <class Work>
    void replay(Recording& /*recording*/, const Work& work) const {
        work();
    }
    /// Waits until all previous work has finished.
    void wait() const {}

  private:
    struct Array {
        std::unique_ptr<std::byte[]> begin;
        std::size_t bytes;  ///< size on a GPU
    };
    Context ctx_;
    std::size_t room_, used_ = 0, most_ = 0;
    std::vector<Array> memory_;
};

}  // namespace coppice::cuda
