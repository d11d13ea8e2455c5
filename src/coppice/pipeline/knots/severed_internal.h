#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/knots/tube_quads_internal.h"

namespace coppice::pipeline_internal {

/// Slices where the quads sever an axis of the field's skeleton, as judge_axes() means it. Looks only at
/// segments with a tube to which quads of that tube, or of those that it meets at branch nodes, come nearer
/// than three quarters of the radius. Ascending. O(n).
std::vector<Slice> severed_slices(const TubeMap& map, const TubeQuads& quads, const Context& ctx);

}  // namespace coppice::pipeline_internal
