#pragma once

#include "coppice/pipeline/knots/slices_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice::pipeline_internal {

/// Replaces the quads of slices that cross others, or themselves, by quads made of the surface that
/// tetrahedra find there, which never crosses itself, until no quads cross; each round takes more of the
/// tubes, or more care, and at last whole trees. `levels`: how often the surface's cage was refined.
KnotReport remesh_knots(QuadSurface& surface, const TubeMap& map, int levels, const MeshOptions& options,
                        const Context& ctx);

}  // namespace coppice::pipeline_internal
