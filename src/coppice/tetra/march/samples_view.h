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

/// How many bits are set.
COPPICE_HOST_DEVICE inline std::uint32_t count_bits(std::uint64_t bits) {
#ifdef __CUDA_ARCH__
    return static_cast<std::uint32_t>(__popcll(bits));
#else
    return static_cast<std::uint32_t>(std::popcount(bits));
#endif
}

/// One bit per item, in words that lie anywhere.
struct BitsView {
    std::span<const std::uint64_t> words;  ///< item i is bit i % 64 of word i / 64

    /// The bit of an item.
    COPPICE_HOST_DEVICE bool test(std::size_t i) const { return (words[i / 64] >> (i % 64) & 1) != 0; }
};

/// The same, and the number of set bits before each word.
struct RankedView {
    std::span<const std::uint64_t> words;   ///< see BitsView
    std::span<const std::uint32_t> before;  ///< of every word

    /// Set bits before item i.
    COPPICE_HOST_DEVICE std::uint32_t rank(std::size_t i) const {
        return before[i / 64] + count_bits(words[i / 64] & ((std::uint64_t{1} << (i % 64)) - 1));
    }
};

/// What is known of every fine vertex, in arrays that lie anywhere. A vertex that lies on the surface counts
/// as outside.
struct SamplesView {
    std::span<const float> height;     ///< of the profile, where the vertex was before it was moved
    BitsView inside;                   ///< which are
    BitsView on;                       ///< moved onto the surface and not put back
    BitsView held;                     ///< inside whatever the field says
    BitsView moved;                    ///< those on the surface, and held ones that were moved
    RankedView placed;                 ///< all that were near enough, put back or not
    std::span<const Vec3> place;       ///< [m] by rank in `placed`: where they were moved
    std::span<const float> way;        ///< [m] by rank in `placed`: how far they were moved
    std::span<const WeakVertex> weak;  ///< ascending

    /// The edge between two vertices that the surface passes between, which were at `a` and `b` before they
    /// were moved.
    COPPICE_HOST_DEVICE CutEdge cut_edge(std::uint32_t from, std::uint32_t to, Vec3 a, Vec3 b,
                                         float clearance) const {
        CutEdge edge = CutEdge::between(a, b, height[from], height[to], clearance);
        if (held.test(from)) hold(from, true, edge);
        if (held.test(to)) hold(to, false, edge);
        return edge;
    }

  private:
    /// An end of an edge that holds an axis may have been moved.
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
