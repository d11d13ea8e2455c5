#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/pipeline/repair/tube_quads_internal.h"

namespace coppice::pipeline_internal {

/// Returns the rows where the quads sever an axis of the field's skeleton, as defined by judge_axes(). Checks
/// only segments with a tube to which quads of that tube, or of those that it meets at branch nodes, are
/// closer than three quarters of the radius. Ascending. O(n).
std::vector<TubeRow> find_severed_rows(const QuadBuild& build, const TubeQuads& quads, const Context& ctx);

}  // namespace coppice::pipeline_internal
