#pragma once

#include <span>
#include <vector>

#include "coppice/base/vec.h"

namespace coppice {

/// Returns twice the signed area of a triangle in plan view, positive for a left turn.
constexpr double turn_in_plan(Vec3d a, Vec3d b, Vec3d c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Returns the corners of the convex hull of points in plan view, counter-clockwise, by Andrew's monotone
/// chain: the lower half, then the upper half backwards. Of points on a line these are the two ends. The
/// hull of hulls is that of all their points. O(n log n).
std::vector<Vec3d> compute_planar_hull(std::vector<Vec3d> points);

/// Returns the area of a convex polygon in plan view, in the squared unit of its corners; 0 for fewer than
/// three corners. O(n).
double compute_planar_area(std::span<const Vec3d> corners);

}  // namespace coppice
