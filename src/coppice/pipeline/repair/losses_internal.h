#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/pipeline/repair/tube_quads_internal.h"

namespace coppice::pipeline_internal {

/// Returns the rows of quads that leave out a thick part of the field's skeleton: a soma that thin branches
/// leave, a stump, the ball at the end of a thread. Only nodes at which this is possible are checked: those
/// that are much thicker than the tubes there, or have segments too steep for tubes. Ascending. O(n).
std::vector<TubeRow> find_lossy_rows(const QuadBuild& build, const TubeQuads& quads, const Context& ctx);

}  // namespace coppice::pipeline_internal
