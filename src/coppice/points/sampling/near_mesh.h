#pragma once

#include <array>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// Which triangle a point lies over.
enum class FaceChoice {
    by_area,  ///< in proportion to the area: even cover
    by_face   ///< each as often as any other: dense where triangles are small
};

template <>
struct EnumNames<FaceChoice> {
    static constexpr std::array<std::string_view, 2> names{"by_area", "by_face"};
};

/// How many points, and how far from the mesh.
struct NearMeshOptions {
    int count = 1000;                         ///< points; 1 to 1e8
    float low = 0;                            ///< [m] least offset along the normal; negative is inside
    float high = 0.1f;                        ///< [m] greatest offset; >= low
    FaceChoice choice = FaceChoice::by_area;  ///< where they are dense
    bool even = false;  ///< spread the points evenly (blue noise) instead of each on its own; by_area only
    int seed = 0;       ///< another seed, another set
    int max_memory = 4096;  ///< [MiB] what would take more is refused before it starts
};

template <class Self, class Visitor>
requires SameOptions<Self, NearMeshOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"count", "number of points", Unit::none, 1, 1e8}, o.count);
    visit(Field{"low", "least offset along the normal; negative is inside", Unit::metre, -1e9, 1e9}, o.low);
    visit(Field{"high", "greatest offset along the normal", Unit::metre, -1e9, 1e9}, o.high);
    visit(Field{"choice", "how often a triangle is chosen"}, o.choice);
    visit(Field{"even", "spread the points evenly"}, o.even);
    visit(Field{"seed", "another seed gives another set", Unit::none, 0, 2147483647}, o.seed);
    visit(Field{"max_memory", "MiB that may be used", Unit::none, 1, 1e6}, o.max_memory);
}

/// Points near a surface: each lies over a random place of a triangle, off it by a random distance between
/// the limits along the normal there, interpolated from those of the vertices. Triangles should be oriented
/// alike; those without area are never chosen. The origin is that of the mesh. Where the surface bends more
/// sharply than the offset, points may come nearer to other parts of it, or inside. Deterministic for any
/// number of threads. O(triangles + count log triangles).
///
/// Throws InvalidInput: options out of range, high below low, no triangle with an area, positions that are
/// not finite, too much memory.
PointSet near_mesh(const TriMesh& mesh, const NearMeshOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
