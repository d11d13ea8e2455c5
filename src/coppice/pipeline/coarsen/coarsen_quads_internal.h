#pragma once

#include "coppice/base/context.h"
#include "coppice/pipeline/coarsen/refined_grid_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice::pipeline_internal {

/// Takes vertices out of a surface so that each tube has as many sides as its radius asks for (see
/// node_levels), and as few rings as stay near the refined ones. Where the number of sides changes, it halves
/// from one ring to the next: six quads for every four sides, with two vertices of valence 3 and one of
/// valence 6. All vertices that stay lie on rays from their anchors as before, moved out so that polygons
/// keep their areas; ends of four sides are shaped as those of a surface without levels. Tubes of which
/// something was remeshed stay as they are. Where quads would cross or be inverted, the nodes get a level
/// more, until none does that the surface given did not have. O(n log n).
CoarsenReport coarsen_quads(QuadSurface& surface, const RefinedQuads& from, const MeshOptions& options,
                            const Context& ctx);

}  // namespace coppice::pipeline_internal
