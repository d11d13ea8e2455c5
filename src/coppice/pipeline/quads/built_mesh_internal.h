#pragma once

#include "coppice/pipeline/mesh_result.h"
#include "coppice/pipeline/quads/quad_build.h"

namespace coppice::pipeline_internal {

/// A surface, and the intermediate results of its quads; these are empty for other methods.
struct BuiltMesh {
    MeshResult result;
    QuadBuild build;
    Skeleton prepared;  ///< of which the surface was made
};

/// Returns the surface of mesh_skeleton() for callers that move it along with its skeleton: only the fit
/// `volume` moves it off the field.
BuiltMesh build_mesh(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx);

}  // namespace coppice::pipeline_internal
