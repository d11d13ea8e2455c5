#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "coppice/base/error.h"

namespace coppice {

/// A priority queue for costs that are never below the last one removed, as in shortest paths: a radix heap
/// [Ahuja1990] on the bits of the costs, which have the order of non-negative doubles. Entries with costs
/// similar to the last one are in a small binary heap, the others in buckets by the highest bit that differs,
/// without the cache misses of a large binary heap. Amortised O(log n) per entry. The order is that of
/// `std::priority_queue`: for equal costs the smallest value comes first.
class RadixHeap {
  public:
    /// A value with its cost.
    struct Entry {
        double cost;          ///< >= 0
        std::uint32_t value;  ///< for equal costs the smallest is removed first
    };

    bool empty() const { return front_.empty() && used_ == 0; }  ///< returns whether the heap is empty

    /// Inserts an entry. The cost must not be less than that of the last entry removed, nor -0 or NaN.
    void push(double cost, std::uint32_t value) {
        const Item item{std::bit_cast<std::uint64_t>(cost), value};
        COPPICE_ASSERT(item.key >= last_ && item.key <= kInfinity);
        if (compute_bucket(item.key) > front_bits_) return put(item);
        front_.push_back(item);
        std::ranges::push_heap(front_, std::greater{});
        if (front_.size() > kLarge && front_bits_ > 0) divide(last_);
    }

    /// Removes and returns the entry of the lowest cost. The heap must not be empty.
    Entry pop() {
        COPPICE_ASSERT(!empty());
        if (front_.empty()) refill();
        std::ranges::pop_heap(front_, std::greater{});
        const Item item = front_.back();
        front_.pop_back();
        last_ = item.key;
        return {std::bit_cast<double>(item.key), item.value};
    }

  private:
    struct Item {
        std::uint64_t key;
        std::uint32_t value;
        auto operator<=>(const Item&) const = default;
    };
    static constexpr std::uint64_t kInfinity = 0x7ff0000000000000u;
    static constexpr std::size_t
        kSmall = 64,
        kLarge = 512;  // sizes of a bucket, and of the front, above which they are divided

    /// Returns the number of low bits in which a key and the base may differ.
    int compute_bucket(std::uint64_t key) const { return std::bit_width(key ^ base_); }

    void put(const Item& item) {
        const int b = compute_bucket(item.key);
        bucket_[static_cast<std::size_t>(b)].push_back(item);
        used_ |= std::uint64_t{1} << b;
    }

    /// Moves the lowest bucket to the front; a small one as a whole.
    void refill() {
        std::vector<Item>& bucket = bucket_[static_cast<std::size_t>(std::countr_zero(used_))];
        used_ &= used_ - 1;
        front_.swap(bucket);
        if (front_.size() > kSmall) return divide(std::ranges::min(front_, {}, &Item::key).key);
        const auto [least, most] = std::ranges::minmax(front_, {}, &Item::key);
        front_bits_ = std::bit_width(least.key ^ most.key);
        base_ = least.key >> front_bits_ << front_bits_;
        std::ranges::make_heap(front_, std::greater{});
    }

    /// Keeps only the items with this key, the minimum of the remaining keys, in the front, and moves the
    /// others to buckets.
    void divide(std::uint64_t least) {
        base_ = least;
        front_bits_ = 0;
        const auto rest =
            std::partition(front_.begin(), front_.end(), [&](const Item& item) { return item.key == base_; });
        std::for_each(rest, front_.end(), [&](const Item& item) { put(item); });
        front_.erase(rest, front_.end());
        std::ranges::make_heap(front_, std::greater{});
    }

    std::vector<Item> front_;  // a heap of items that differ from the base in at most front_bits_ low bits
    std::array<std::vector<Item>, 64> bucket_;  // by the highest bit that differs
    std::uint64_t base_ = 0, last_ = 0;         // lower bound of all keys; key of the last removed item
    std::uint64_t used_ = 0;                    // one bit for every non-empty bucket
    int front_bits_ = 0;
};

}  // namespace coppice
