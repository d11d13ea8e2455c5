#pragma once

#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/stages_internal.h"

namespace coppice {

/// The surface of the field of a prepared skeleton by tetrahedra: fills in triangles, tetra and the stages.
void mesh_by_tetrahedra(const Skeleton& prepared, const PointSet& constraints, const MeshOptions& options,
                        const Context& ctx, Stages& stages, MeshResult& out);

}  // namespace coppice
