#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice::extract_internal {

/// The nearest other points of every point, near to far, in rows of equal length.
struct Neighbours {
    std::uint32_t count = 0;  ///< in each row; less than asked for only where there are too few points
    Buffer<std::uint32_t> index;
    Buffer<float> distance;  ///< [m]

    std::span<const std::uint32_t> of(std::size_t i) const { return {index.data() + i * count, count}; }
    std::span<const float> distances(std::size_t i) const { return {distance.data() + i * count, count}; }
    bool lists(std::size_t row, std::uint32_t point) const {
        return std::ranges::find(of(row), point) != of(row).end();
    }
};

/// At least one point, at most 2^32 - 2. Points that are near in memory should be near in space. O(n log n).
Neighbours nearest_neighbours(std::span<const Vec3> points, std::uint32_t count, const Context& ctx);

/// The distance to the `rank`-th neighbour of every point [m].
Buffer<float> local_spacing(const Neighbours& neighbours, std::uint32_t rank);

}  // namespace coppice::extract_internal
