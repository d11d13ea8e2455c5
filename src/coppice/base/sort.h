#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/parallel.h"

namespace coppice {

/// Sorts items and removes duplicates. O(n log n).
template <class Items>
void sort_unique(Items& items) {
    std::sort(items.begin(), items.end());
    items.erase(std::unique(items.begin(), items.end()), items.end());
}

/// Sorts items by the lowest `bits` bits of key(item); stable. O(n bits / 11), parallel; the result does not
/// depend on the number of threads; uses one copy of the items as temporary memory. At most 2^32 - 1 items.
template <class T, class Key>
void radix_sort(const Context& ctx, Buffer<T>& items, unsigned bits, const Key& key) {
    constexpr unsigned kDigit = 11;
    constexpr std::size_t kBuckets = std::size_t{1} << kDigit;
    constexpr std::size_t kGrain = std::size_t{1} << 16;
    COPPICE_ASSERT(items.size() < std::numeric_limits<std::uint32_t>::max());
    using Counts = std::array<std::uint32_t, kBuckets>;
    std::vector<Counts> first((items.size() + kGrain - 1) / kGrain);
    Buffer<T> sorted(items.size());
    for (unsigned shift = 0; shift < bits; shift += kDigit) {
        const auto digit = [&](const T& item) { return (key(item) >> shift) & (kBuckets - 1); };
        parallel_for_ranges(ctx, items.size(), kGrain, [&](IndexRange range) {
            Counts& count = first[range.begin / kGrain];
            count.fill(0);
            for (std::size_t i = range.begin; i < range.end; ++i) ++count[digit(items[i])];
        });
        std::uint32_t sum = 0;
        for (std::size_t b = 0; b < kBuckets; ++b) {
            for (Counts& count : first) sum += std::exchange(count[b], sum);
        }
        parallel_for_ranges(ctx, items.size(), kGrain, [&](IndexRange range) {
            Counts& next = first[range.begin / kGrain];
            for (std::size_t i = range.begin; i < range.end; ++i) sorted[next[digit(items[i])]++] = items[i];
        });
        items.swap(sorted);
    }
}

}  // namespace coppice
