#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/pipeline/stages_internal.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A surface of quads without its cage, which is part of the build.
struct BuiltQuads {
    QuadSurface surface;
    QuadBuild build;
};

/// Use of a surface of quads after it is built.
struct QuadUse {
    bool is_posed = false;  ///< whether it is projected again for each pose of its skeleton
    /// Called with the refined mesh before it is remeshed; returns per tube whether it has to be checked.
    std::function<std::vector<std::uint8_t>(const QuadMesh&, const QuadBuild&)> wanted = {};
};

/// Returns only the skeletons and the cage of MeshMethod::quads.
QuadBuild build_cage(const Skeleton& prepared, const MeshOptions& options, const Context& ctx);

/// Implements MeshMethod::quads for a prepared skeleton.
BuiltQuads mesh_by_quads(const Skeleton& prepared, const PointSet& constraints, const MeshOptions& options,
                         const QuadUse& use, const Context& ctx, Stages& stages);

/// Implements MeshMethod::ramifications for a prepared skeleton.
BuiltQuads mesh_by_ramifications(const Skeleton& prepared, const PointSet& constraints,
                                 const MeshOptions& options, const Context& ctx, Stages& stages);

/// Throws InvalidInput naming a node at which more branches begin than a closed surface can join.
void check_branches(const Skeleton& s);

/// Returns the options of the quads that implement MeshMethod::bmesh. Throws InvalidInput naming a kernel
/// without balls.
MeshOptions on_metaballs(MeshOptions options);

}  // namespace coppice
