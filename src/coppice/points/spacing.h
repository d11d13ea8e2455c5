#pragma once

#include <optional>
#include <string>

#include "coppice/base/context.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// [m] The median distance from a point to its nearest other one, by a sample of a few thousand; 0 for fewer
/// than two points. O(n log n).
double median_spacing(const PointSet& points, const Context& ctx = {});

/// A sentence where points extend more than 50 times as far along one axis as along the others, as they do
/// when another column was read for a coordinate; none otherwise, and for two points, which lie on a line.
std::optional<std::string> warning_of_extent(const PointSet& points);

}  // namespace coppice
