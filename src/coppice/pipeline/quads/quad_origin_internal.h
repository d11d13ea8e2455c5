#pragma once

#include <span>
#include <vector>

#include "coppice/field/convolution_field.h"
#include "coppice/pipeline/fit/kept_quads_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice::pipeline_internal {

/// What a surface of quads was made by, for those who move it along with its skeleton.
struct QuadOrigin {
    QuadRows rows{{}, Skeleton({NodeId::none()}, {Vec3{}}, {1.0f}), 0};  ///< before knots were remeshed
    Buffer<Vec3> anchors;                                                ///< per vertex of the rows
    Skeleton field{{NodeId::none()}, {Vec3{}}, {1.0f}};                  ///< whose field the surface is
    std::vector<NodeId> source;  ///< per node of the tubes: that of the field's skeleton
    std::vector<NodeId> tube;    ///< the other way around: see TubeTree
};

/// The same surface as mesh_skeleton(), with what it was made by. For MeshMethod::quads and bmesh; else the
/// origin is left as it is.
MeshResult mesh_with_origin(const Skeleton& skeleton, const MeshOptions& options, QuadOrigin& origin,
                            const Context& ctx);

/// Regions of boxes that hold all of their points, in want of a margin and of the seeds that they are named
/// by.
void complete(std::vector<FieldRegion>& regions, std::span<const NodeId> seeds, const Skeleton& skeleton);

}  // namespace coppice::pipeline_internal
