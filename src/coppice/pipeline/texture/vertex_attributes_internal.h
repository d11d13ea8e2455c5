#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/vertex_attribute.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// Returns for every vertex the values of the skeleton at the closest point of a segment: the order and the
/// number of the branch, as in list_branches(), the distance [m] along it from its beginning, and the radius
/// [m]. Vertices of tubes belong to the segment that the tube wraps, or the adjacent one of its branch if it
/// is closer; those between two branches to the one of lower order; those of repair patches to the closest
/// segment, in radii.
/// `prepared` is the skeleton from which the surface was built. O(n log n).
std::vector<VertexAttribute> vertex_attributes(const QuadMesh& mesh, const QuadBuild& build,
                                               const Skeleton& prepared, const Context& ctx);

/// Returns the same for any surface, by the closest segments in radii. `origin`: [m] of the positions.
std::vector<VertexAttribute> vertex_attributes(std::span<const Vec3> positions, Vec3d origin,
                                               const Skeleton& prepared, const Context& ctx);

}  // namespace coppice::pipeline_internal
