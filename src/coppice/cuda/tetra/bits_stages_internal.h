#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/exec/atomics_internal.h"
#include "coppice/tetra/march/samples_view.h"

// Sets of numbers as bits on an executor.

namespace coppice::cuda {

/// Sets the bit of an item.
COPPICE_HOST_DEVICE inline void set_bit(std::span<std::uint64_t> words, std::uint32_t i) {
    set_bits(words[i / 64], std::uint64_t{1} << (i % 64));
}

/// Sets every item to one value.
template <class T>
struct Fill {
    std::span<T> items;
    T value;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { items[i] = value; }
};

/// Counts the bits of every word.
struct CountBits {
    std::span<const std::uint64_t> words;
    std::span<std::uint32_t> count;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t w) const {
        count[w] = tetra_kernel::count_bits(words[w]);
    }
};

/// Lists the items with set bits.
struct ListBits {
    std::span<const std::uint64_t> words;
    std::span<const std::uint32_t> before;  ///< number of bits before every word
    std::span<std::uint32_t> list;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t w) const {
        std::uint32_t at = before[w];
        for (std::uint64_t rest = words[w]; rest != 0; rest &= rest - 1)
            list[at++] = 64 * w + tetra_kernel::count_bits((rest & (~rest + 1)) - 1);
    }
};

/// Allocates cleared bits for `count` items.
template <class Exec>
std::span<std::uint64_t> no_bits(Exec& exec, std::size_t count) {
    const auto words = exec.template array<std::uint64_t>(count / 64 + 1);
    exec.clear(words);
    return words;
}

/// Replaces all counts except the last by the sum of those before, and the last by the total; returns the
/// total.
template <class Exec, class T>
T place_counts(Exec& exec, std::span<T> counts) {
    exec.clear(counts.last(1));
    exec.exclusive_scan(std::span<const T>(counts), counts);
    T total{};
    exec.download(std::span<const T>(counts.last(1)), std::span(&total, 1));
    return total;
}

/// Bits and their ranks.
struct CountedBits {
    tetra_kernel::RankedView view;  ///< on the executor
    std::uint32_t count = 0;        ///< number of set bits
};

/// Counts bits. Waits.
template <class Exec>
CountedBits rank_bits(Exec& exec, std::span<const std::uint64_t> words) {
    const auto before = exec.template array<std::uint32_t>(words.size() + 1);
    exec.each("count bits", words.size(), CountBits{words, before});
    const std::uint32_t count = place_counts(exec, before);
    return {{words, before}, count};
}

/// Returns the items with set bits, ascending.
template <class Exec>
std::span<const std::uint32_t> list_bits(Exec& exec, const CountedBits& bits) {
    const auto list = exec.template array<std::uint32_t>(bits.count);
    if (bits.count > 0)
        exec.each("list bits", bits.view.words.size(), ListBits{bits.view.words, bits.view.before, list});
    return list;
}
/// Lists bits that were not counted. Waits.
template <class Exec>
std::span<const std::uint32_t> list_bits(Exec& exec, std::span<const std::uint64_t> words) {
    return list_bits(exec, rank_bits(exec, words));
}

}  // namespace coppice::cuda
