#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Returns the outward normal of a quad; its length is twice the area of the quad between the midpoints of
/// its sides.
COPPICE_HOST_DEVICE inline Vec3 area_normal(std::span<const Vec3> positions, const Quad& q) {
    return cross(positions[q[2]] - positions[q[0]], positions[q[3]] - positions[q[1]]);
}

/// Returns the area-weighted unit normal of a vertex from the adjacent quads in the given order; +Z if they
/// cancel.
COPPICE_HOST_DEVICE inline Vec3 fan_normal(std::span<const Vec3> positions, std::span<const Quad> quads,
                                           std::span<const std::uint32_t> fan) {
    Vec3 sum;
    for (const std::uint32_t f : fan) sum += area_normal(positions, quads[f]);
    return normalized(sum);
}

/// Returns the area-weighted unit normal of each vertex from the adjacent quads in their order; +Z if they
/// cancel. O(n).
Buffer<Vec3> smooth_normals(std::span<const Vec3> positions, std::span<const Quad> quads);
/// Returns the area-weighted unit normal of each vertex from the adjacent triangles.
Buffer<Vec3> smooth_normals(const TriMesh& mesh);

}  // namespace coppice
