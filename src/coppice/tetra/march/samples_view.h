#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"
#include "coppice/tetra/march/kernel/cut_edge_kernel.h"

namespace coppice::tetra_kernel {

/// Returns the number of set bits.
COPPICE_HOST_DEVICE inline std::uint32_t count_bits(std::uint64_t bits) {
#ifdef __CUDA_ARCH__
    return static_cast<std::uint32_t>(__popcll(bits));
#else
    return static_cast<std::uint32_t>(std::popcount(bits));
#endif
}

/// One bit per item, in words in any memory.
struct BitsView {
    std::span<const std::uint64_t> words;  ///< item i is bit i % 64 of word i / 64

    /// Returns the bit of an item.
    COPPICE_HOST_DEVICE bool test(std::size_t i) const { return (words[i / 64] >> (i % 64) & 1) != 0; }
};

/// Bits with the number of set bits before each word.
struct RankedView {
    std::span<const std::uint64_t> words;   ///< see BitsView
    std::span<const std::uint32_t> before;  ///< of every word

    /// Returns the number of set bits before item i.
    COPPICE_HOST_DEVICE std::uint32_t rank(std::size_t i) const {
        return before[i / 64] + count_bits(words[i / 64] & ((std::uint64_t{1} << (i % 64)) - 1));
    }
};

/// Properties of every fine vertex, in arrays in any memory. A vertex on the surface counts as outside.
struct SamplesView {
    std::span<const float> height;     ///< height of the profile at the original position of the vertex
    BitsView inside;                   ///< vertices inside
    BitsView on;                       ///< moved onto the surface and not moved back
    BitsView held;                     ///< inside for any field
    BitsView moved;                    ///< vertices on the surface, and held vertices that were moved
    RankedView placed;                 ///< all that were close enough, moved back or not
    std::span<const Vec3> place;       ///< [m] by rank in `placed`: moved position
    std::span<const float> way;        ///< [m] by rank in `placed`: distance of the move
    std::span<const WeakVertex> weak;  ///< ascending

    /// Returns the edge between two vertices on different sides of the surface, with original positions `a`
    /// and `b`.
    COPPICE_HOST_DEVICE CutEdge cut_edge(std::uint32_t from, std::uint32_t to, Vec3 a, Vec3 b,
                                         float clearance) const {
        CutEdge edge = CutEdge::between(a, b, height[from], height[to], clearance);
        if (held.test(from)) hold(from, true, edge);
        if (held.test(to)) hold(to, false, edge);
        return edge;
    }

  private:
    /// Adjusts an end that holds an axis and may have been moved.
    COPPICE_HOST_DEVICE void hold(std::uint32_t vertex, bool at_a, CutEdge& edge) const {
        std::size_t first = 0, last = weak.size();
        while (first < last) {
            const std::size_t middle = (first + last) / 2;
            (weak[middle].vertex < vertex ? first : last) =
                weak[middle].vertex < vertex ? middle + 1 : middle;
        }
        if (first == weak.size() || weak[first].vertex != vertex) return;
        const WeakVertex& found = weak[first];
        float& at_end = at_a ? edge.at_low : edge.at_high;
        float away = found.away;
        if (moved.test(vertex)) {
            const std::uint32_t r = placed.rank(vertex);
            (at_a ? edge.a : edge.b) = place[r];
            at_end = found.height;
            away -= way[r];
        }
        edge.thicken(found, at_end, away, at_a);
    }
};

}  // namespace coppice::tetra_kernel
