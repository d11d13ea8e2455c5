#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coppice/remesh/boundary.h"

namespace coppice {

/// An axis with a direction, about which loops wind.
struct LoopAxis {
    Vec3 center;     ///< a point of it
    Vec3 direction;  ///< of length 1
};

/// Turns that a loop makes about an axis, counter-clockwise seen from where the direction points; 0 when it
/// does not go around. O(n).
int winding(const Loop& loop, std::span<const Vec3> positions, const LoopAxis& axis);

/// The band of triangles between two loops that go around an axis once, in the same sense: `outer` keeps its
/// direction in the triangles, `inner` is run through against its own. Corners of both follow each other in
/// the order of their angles, so that loops that are graphs over the circle, one beyond the other, get a band
/// that does not cross itself. None when they do not wind alike. O(n).
std::optional<std::vector<Triangle>> zip(const Loop& outer, const Loop& inner,
                                         std::span<const Vec3> positions, const LoopAxis& axis);

}  // namespace coppice
