#pragma once

#include <vector>

#include "coppice/foliage/outline_internal.h"

namespace coppice::foliage_internal {

/// Reduces points to the corners of their convex hull, counter-clockwise. O(n log n).
void keep_hull(std::vector<Point2>& points);

/// Returns the area of a polygon [m^2].
double compute_area(const std::vector<Point2>& corners);

}  // namespace coppice::foliage_internal
