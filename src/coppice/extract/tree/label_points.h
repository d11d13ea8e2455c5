#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/context.h"
#include "coppice/extract/extract_result.h"
#include "coppice/points/point_cloud.h"

namespace coppice {

/// Labels points of a scan by the skeleton extracted from it: with their distance from the surface of the
/// branch that is closest in radii, its order and evidence, and whether they are wood: within half its radius
/// of that surface, or within half a spacing. `which` contains the indices of the points; `spacing` [m] is
/// the spacing of the extraction (CloudReport::spacing). Missing columns are added; for other points
/// distances are NaN and all other values 0. A skeleton without segments labels no points. O(n log nodes).
/// The result does not depend on the number of threads. Throws Cancelled.
void label_points(PointCloud& scan, std::span<const std::uint32_t> which, const ExtractResult& tree,
                  double spacing, const Context& ctx = {});

}  // namespace coppice
