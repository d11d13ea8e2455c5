#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/knots/tube_quads_internal.h"

namespace coppice::pipeline_internal {

/// Slices whose quads leave out something thick that the field's skeleton has: a soma that thin branches
/// leave, a stump, the ball at the end of a thread. Looks only at nodes where that can be: much thicker than
/// the tubes there, or of segments steeper than tubes can follow. Ascending. O(n).
std::vector<Slice> lossy_slices(const TubeMap& map, const TubeQuads& quads, const Context& ctx);

}  // namespace coppice::pipeline_internal
