#pragma once

#include <array>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// Selection of the triangle of a point.
enum class FaceChoice {
    by_area,  ///< proportional to the area: uniform density
    by_face   ///< with equal probability: dense where triangles are small
};

template <>
struct EnumNames<FaceChoice> {
    static constexpr std::array<std::string_view, 2> names{"by_area", "by_face"};
};

/// Options of `near_mesh`.
struct NearMeshOptions {
    int count = 1000;                         ///< number of points; 1 to 1e8
    float low = 0;                            ///< [m] minimum offset along the normal; negative is inside
    float high = 0.1f;                        ///< [m] maximum offset; >= low
    FaceChoice choice = FaceChoice::by_area;  ///< selection of triangles
    bool even = false;  ///< distribute the points evenly (blue noise) instead of independently; by_area only
    int seed = 0;       ///< random seed
    int max_memory = 4096;  ///< [MiB] maximum memory; larger requests are refused in advance
};

/// Lists the members for front ends.
void list_fields(NearMeshOptions& o, FieldList& list);

/// Generates points near a surface: each is at a random point of a triangle plus a random offset between the
/// limits along the interpolated vertex normal. Triangles should be oriented consistently; those without area
/// are never selected. The origin is that of the mesh. Where the radius of curvature of the surface is
/// smaller than the offset, points may be closer to another part of it, or inside. The result does not depend
/// on the number of threads. O(triangles + count log triangles).
///
/// Throws InvalidInput for options out of range, high below low, no triangle with an area, positions that are
/// not finite, or too much memory.
PointSet near_mesh(const TriMesh& mesh, const NearMeshOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
