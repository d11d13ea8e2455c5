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

    /// Launches that are made again at once: see replay().
    class Recording {
      public:
        void clear() {}  ///< forgets them
    };

    /// Runs with the context's threads, and stops with it. Arrays may take `room` bytes, as if a card had no
    /// more.
    explicit HostExecutor(const Context& ctx = {}, std::size_t room = std::numeric_limits<std::size_t>::max())
        : ctx_(ctx), room_(room) {}

    /// [bytes] That all arrays together may take.
    std::size_t room() const { return room_; }
    /// Makes sure of so much memory at once. Throws DeviceError when there is less.
    void reserve(std::size_t bytes) const { require_room(room_, bytes); }
    /// [bytes] That arrays took at once since reset().
    std::size_t bytes_used() const { return most_; }

    /// Memory for `count` numbers, not set, until reset(). Throws DeviceError when there is none left.
    template <class T>
    std::span<T> array(std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        constexpr std::size_t kAlignment = 256;  // of arrays on a card
        const std::size_t bytes = (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
        require_room(room_, used_ + bytes);
        // Each one of its own, so that a sanitizer sees who reads beyond.
        memory_.push_back(
            {std::make_unique_for_overwrite<std::byte[]>(std::max<std::size_t>(1, count) * sizeof(T)),
             bytes});
        used_ += bytes;
        most_ = std::max(most_, used_);
        return {reinterpret_cast<T*>(memory_.back().begin.get()), count};
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
    /// The same without waiting: the values are there after wait(), until rewind() or reset().
    template <class T>
    std::span<const T> fetch(std::span<const T> from) {
        return upload(from);
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
    void rewind(Mark mark) {
        while (memory_.size() > mark) {
            used_ -= memory_.back().bytes;
            memory_.pop_back();
        }
    }
    /// Frees all arrays.
    void reset() {
        rewind(0);
        most_ = 0;
    }

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
    /// Does the work of work(), which begins the same launches in the same arrays every time, neither writes
    /// nor downloads, and does not wait. A card is told of them once, and then does them all at one word.
    template <class Work>
    void replay(Recording& /*recording*/, const Work& work) const {
        work();
    }
    /// Waits until all that was begun has been done.
    void wait() const {}

  private:
    struct Array {
        std::unique_ptr<std::byte[]> begin;
        std::size_t bytes;  ///< that it would take on a card
    };
    Context ctx_;
    std::size_t room_, used_ = 0, most_ = 0;
    std::vector<Array> memory_;
};

}  // namespace coppice::cuda
