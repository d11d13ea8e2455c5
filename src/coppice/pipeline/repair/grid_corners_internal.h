#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/remesh/coarsen_triangles_internal.h"
#include "coppice/pipeline/repair/patch_internal.h"

namespace coppice::pipeline_internal {

/// Returns for each vertex of a level set the closest corner of a grid around its axis: a whole number of
/// cells of about `edge` radii around the axis, and cells of the same size along it, counted from the root of
/// each branch. Spacing is 0 where no axis is known. O(n).
std::vector<GridCorner> compute_grid_corners(const Marched& marched, const PatchSkeleton& patch_skeleton,
                                             float edge, const Context& ctx);

}  // namespace coppice::pipeline_internal
