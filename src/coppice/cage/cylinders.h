#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/cage/cage.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/texture.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Number of faces around the tubes of thin axes.
enum class TubeSides {
    equal,      ///< the same number as around thick ones
    by_radius,  ///< number for a constant distance of chords from circles, in metres; at least 3 or 4
    automatic,  ///< by_radius if a number of faces is requested, otherwise equal
};

template <>
struct EnumNames<TubeSides> {
    static constexpr std::array<std::string_view, 3> names{"equal", "by_radius", "automatic"};
};

/// Options of generalized cylinders.
struct CylinderOptions {
    int sides = 16;                     ///< around the thickest axis; in [3, 2048]
    int rows = 4;                       ///< rows of faces along each segment; in [1, 64]
    TubeSides thin = TubeSides::equal;  ///< around thinner axes; automatic is equal
    TipShape tips = TipShape::round;    ///< shape of the ends of axes
    float tile = 0;                     ///< [m] width of a tile of the texture; 0 = one tile around a tube
    BaseShape base = BaseShape::flat;   ///< shape of the beginning of a tree at a root with one child
};

/// Counts of generalized cylinders.
struct CylinderReport {
    std::uint32_t tubes = 0;      ///< one per axis
    std::uint64_t rings = 0;      ///< rings of vertices around the tubes, including caps
    std::uint32_t min_sides = 0;  ///< minimum number around a tube
    std::uint32_t max_sides = 0;  ///< maximum number around a tube
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const CylinderReport& r, Visitor&& visit) {
    visit("tubes", r.tubes);
    visit("rings", r.rings);
    visit("min_sides", r.min_sides);
    visit("max_sides", r.max_sides);
}

/// Tubes and their counts.
struct CylinderMesh {
    PolygonMesh mesh;              ///< quads; in caps with an odd number of sides also a triangle
    Buffer<TexturePoint> texture;  ///< of each corner of the mesh
    CylinderReport report;         ///< counts
};

/// Builds generalized cylinders: a separate tube for every axis, as in the comparison of [Huang2017] and as
/// in trees of games. An axis begins at a root, or at the node where it leaves another one, and follows the
/// thickest children to a tip. It is a Hermite spline through its nodes, with tangents by finite differences
/// over the lengths, so that uneven nodes cause no loops; radii are linear between nodes. Circles are in
/// frames that turn about the axis as little as possible [Wang2008].
///
/// Every tube is closed, except for an open base: half balls at round ends, which reach a radius beyond the
/// last node, discs at flat ones and inside the axis that it leaves. A single node is a ball. Tubes intersect
/// each other at forks, and where an axis bends more tightly than its radius.
///
/// Vertices are stored tube by tube and ring by ring from beginning to end, first the pole of the base; in
/// each ring the first vertex is on the seam of the texture. In a texture, u is the position in the ring, and
/// v the length along the axis and over the caps, divided by the tube's maximum circumference: a square
/// texture is not distorted there. Both are multiplied by the number of tiles around the tube.
///
/// Throws InvalidInput naming an option out of range, or if there would be 2^31 vertices or more. O(size of
/// the mesh); the result does not depend on the number of threads.
CylinderMesh cylinders(const Skeleton& skeleton, const CylinderOptions& options = {},
                       const Context& ctx = {});

}  // namespace coppice
