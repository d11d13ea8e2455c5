#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coppice/pipeline/remesh/boundary_internal.h"

namespace coppice {

/// A directed axis around which loops wind.
struct LoopAxis {
    Vec3 center;     ///< a point of it
    Vec3 direction;  ///< of length 1
};

/// Returns the number of turns of a loop around an axis, counter-clockwise seen from the side to which the
/// direction points; 0 if it does not run around it. O(n).
int winding(const Loop& loop, std::span<const Vec3> positions, const LoopAxis& axis);

/// Returns the band of triangles between two loops that run around an axis once, in the same direction:
/// `outer` keeps its direction in the triangles, `inner` is reversed. Corners of both are joined in the order
/// of their angles, so that loops that are graphs over the circle, one beyond the other, get a band without
/// self-intersections. Returns nullopt if their windings differ. O(n).
std::optional<std::vector<Triangle>> zip(const Loop& outer, const Loop& inner,
                                         std::span<const Vec3> positions, const LoopAxis& axis);

}  // namespace coppice
