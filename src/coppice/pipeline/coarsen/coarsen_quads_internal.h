#pragma once

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/pipeline/quads/quad_build.h"

namespace coppice::pipeline_internal {

/// Removes vertices from the mesh of a surface so that each tube has as many sides as its radius requires
/// (see node_levels), and as few rings as stay near the refined ones. Where the number of sides changes, it
/// halves from one ring to the next: six quads for every four sides, with two vertices of valence 3 and one
/// of valence 6. All kept vertices are on rays from their anchors as before, moved outward so that polygons
/// keep their areas; ends of four sides are shaped as those of a surface without levels. Tubes that were
/// partly remeshed stay unchanged. Where quads would cross or be inverted, the nodes get one more level,
/// until no quad does that did not in the given surface. Sets `build.coarse`. O(n log n).
CoarsenReport coarsen_quads(QuadMesh& mesh, QuadBuild& build, const Context& ctx);

}  // namespace coppice::pipeline_internal
