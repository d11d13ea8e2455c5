#pragma once

#include <optional>
#include <string>

#include "coppice/base/context.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// Returns the median distance [m] from a point to its closest other one, from a sample of a few thousand
/// points; 0 for fewer than two points. O(n log n).
double median_spacing(const PointSet& points, const Context& ctx = {});

/// Returns a warning if points extend more than 50 times as far along one axis as along the others, for
/// example if a wrong column was read as a coordinate; nullopt otherwise, and for two points, which are
/// always collinear.
std::optional<std::string> warning_of_extent(const PointSet& points);

}  // namespace coppice
