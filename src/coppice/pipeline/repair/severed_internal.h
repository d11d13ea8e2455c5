#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/pipeline/repair/tube_quads_internal.h"

namespace coppice::pipeline_internal {

/// Returns whether a node is a tip, and its branch is in the tube of another one.
bool is_hidden_tip(NodeId n, const QuadBuild& build);

/// Returns the rows where the quads sever an axis of the field's skeleton, as defined by judge_axes(), or end
/// before a hidden tip. Checks only hidden tips, and segments with a tube to which quads of that tube, or of
/// those that it meets at branch nodes, are closer than three quarters of the radius. Ascending. O(n).
std::vector<TubeRow> find_severed_rows(const QuadBuild& build, const TubeQuads& quads, const Context& ctx);

}  // namespace coppice::pipeline_internal
