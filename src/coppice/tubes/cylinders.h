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

/// How many faces go around the tubes of thin axes.
enum class TubeSides {
    equal,      ///< as many as around thick ones
    by_radius,  ///< as many as keep chords equally far from their circles, in metres; 3 or 4 at least
    automatic,  ///< by_radius where a number of faces is asked for, else equal
};

template <>
struct EnumNames<TubeSides> {
    static constexpr std::array<std::string_view, 3> names{"equal", "by_radius", "automatic"};
};

/// How generalized cylinders are made.
struct CylinderOptions {
    int sides = 16;                     ///< around the thickest axis; in [3, 2048]
    int rows = 4;                       ///< of faces along each segment; in [1, 64]
    TubeSides thin = TubeSides::equal;  ///< around thinner axes; automatic is equal
    TipShape tips = TipShape::round;    ///< how axes end
    BaseShape base = BaseShape::flat;   ///< how a tree begins at a root with one child
};

/// What generalized cylinders consist of.
struct CylinderReport {
    std::uint32_t tubes = 0;        ///< one per axis
    std::uint64_t rings = 0;        ///< of vertices around them, caps included
    std::uint32_t least_sides = 0;  ///< around any of them
    std::uint32_t most_sides = 0;   ///< around any of them
};

/// Tubes, and what they consist of.
struct CylinderMesh {
    PolygonMesh mesh;              ///< quads; in caps with an odd number of sides a triangle too
    Buffer<TexturePoint> texture;  ///< of each corner of the mesh
    CylinderReport report;         ///< counts
};

/// Generalized cylinders: a tube for every axis, not joined to the others, as [Huang2017] holds beside its
/// meshes and as games take for trees. An axis begins at a root, or at the node where it leaves another one,
/// and follows the thickest children to a tip. It is a Hermite spline through its nodes, with tangents by
/// finite differences over the lengths, so that uneven nodes make no loops; radii are linear between nodes.
/// Circles lie in frames that turn about the axis as little as they can [Wang2008].
///
/// Every tube is closed, but for an open base: half balls at round ends, which reach a radius beyond the last
/// node, discs at flat ones and inside the axis that it leaves. A lone node is a ball. Tubes run through each
/// other at forks, and where an axis bends more tightly than its radius.
///
/// Vertices are stored tube by tube and ring by ring from beginning to end, first the pole of the base; in
/// each ring the first lies on the seam. On a texture u is the place in the ring, and v the way along the
/// axis and over the caps, over the tube's greatest circumference: a square texture is not distorted there.
///
/// Throws InvalidInput naming an option out of range, or when there would be 2^31 vertices or more. O(size of
/// the mesh); the same bits for any number of threads.
CylinderMesh cylinders(const Skeleton& skeleton, const CylinderOptions& options = {},
                       const Context& ctx = {});

}  // namespace coppice
