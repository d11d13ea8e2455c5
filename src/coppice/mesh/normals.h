#pragma once

#include <span>

#include "coppice/base/column.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Outward, as long as twice the area of the quad between the middles of its sides.
inline Vec3 area_normal(std::span<const Vec3> positions, const Quad& q) {
    return cross(positions[q[2]] - positions[q[0]], positions[q[3]] - positions[q[1]]);
}

/// Unit normals per vertex, from the quads about it in their order, weighted by area; +Z where they cancel.
/// O(n).
Buffer<Vec3> smooth_normals(std::span<const Vec3> positions, std::span<const Quad> quads);
/// The same of triangles.
Buffer<Vec3> smooth_normals(const TriMesh& mesh);

}  // namespace coppice
