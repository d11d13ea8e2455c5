#pragma once

#include <span>
#include <vector>

#include "coppice/field/convolution_field.h"
#include "coppice/pipeline/fit/kept_quads_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice::pipeline_internal {

/// The intermediate results of a surface of quads, for callers that move it along with its skeleton.
struct QuadOrigin {
    QuadRows rows{{}, Skeleton({NodeId::none()}, {Vec3{}}, {1.0f}), 0};  ///< before remeshing
    Buffer<Vec3> anchors;                                                ///< per vertex of the rows
    Skeleton field{{NodeId::none()}, {Vec3{}}, {1.0f}};  ///< skeleton of the field of the surface
    std::vector<NodeId> source;  ///< per node of the tubes: the node of the field's skeleton
    std::vector<NodeId> tube;    ///< inverse of source: see TubeTree
};

/// Returns the surface of mesh_skeleton() and its intermediate results. Supports MeshMethod::quads and bmesh;
/// for other methods the origin is unchanged.
MeshResult mesh_with_origin(const Skeleton& skeleton, const MeshOptions& options, QuadOrigin& origin,
                            const Context& ctx);

/// Completes regions of boxes that contain all of their points: adds a margin and their seeds.
void complete(std::vector<FieldRegion>& regions, std::span<const NodeId> seeds, const Skeleton& skeleton);

}  // namespace coppice::pipeline_internal
