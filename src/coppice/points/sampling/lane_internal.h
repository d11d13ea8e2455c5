#pragma once

#include <optional>

#include "coppice/points/sampling/cells_internal.h"
#include "coppice/points/sampling/lane.h"

namespace coppice::points_internal {

/// `sample_lane` for a caller that has surveyed the region: where the cells are of the voxels that Lane's
/// method would take and not yet cut, they are not made anew. Options and box must have been checked.
LaneResult sample_lane_in_cells(const PointRegion& region, const RadialKernel& kernel,
                                const LaneOptions& options, Cells surveyed, const Context& ctx);

}  // namespace coppice::points_internal
