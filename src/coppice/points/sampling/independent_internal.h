#pragma once

#include <cstddef>
#include <cstdint>

#include "coppice/points/point_set.h"
#include "coppice/points/sampling/cells_internal.h"

namespace coppice::points_internal {

struct Draws {
    Buffer<Vec3> points;      ///< in the order of the draws: the first n are n independent points
    std::uint64_t tries = 0;  ///< number of candidates
};

/// Draws `count` independent points from the density; fewer if almost no candidate is accepted.
Draws draw_independent(const PointRegion& region, const Cells& cells, std::size_t count, std::uint64_t seed,
                       const Context& ctx);
double independent_bytes(double count);

/// Draws one random point in each cube of a lattice, accepted with the probability density /
/// `capacity.largest`.
Draws draw_jittered(const PointRegion& region, const Capacity& capacity, double count, std::uint64_t seed,
                    const Context& ctx);

}  // namespace coppice::points_internal
