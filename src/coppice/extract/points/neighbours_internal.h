#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice::extract_internal {

/// Closest other points of every point, sorted by distance, in rows of equal length.
struct Neighbours {
    std::uint32_t count = 0;  ///< in each row; less than requested only if there are too few points
    Buffer<std::uint32_t> index;
    Buffer<float> distance;  ///< [m]

    std::span<const std::uint32_t> of(std::size_t i) const { return {index.data() + i * count, count}; }
    std::span<const float> distances(std::size_t i) const { return {distance.data() + i * count, count}; }
    bool lists(std::size_t row, std::uint32_t point) const {
        return std::ranges::find(of(row), point) != of(row).end();
    }
};

/// Finds the closest points of every point. Requires 1 to 2^32 - 2 points. Points close in space should be
/// close in memory. O(n log n).
Neighbours nearest_neighbours(std::span<const Vec3> points, std::uint32_t count, const Context& ctx);

/// Returns the distance [m] of every point to its `rank`-th neighbour.
Buffer<float> local_spacing(const Neighbours& neighbours, std::uint32_t rank);

/// Returns the distance [m] of every point to those next to it, from the number of neighbours by distance:
/// it grows with the power d of the distance, and a lattice of dimension d has 2 d points next to each.
/// d is 1 along twigs and 2 on surfaces, and limited to that range.
Buffer<float> local_step(const Neighbours& neighbours, std::uint32_t rank);

}  // namespace coppice::extract_internal
