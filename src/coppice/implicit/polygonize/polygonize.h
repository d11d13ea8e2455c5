#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// How fine the grid is, and how exactly vertices lie on the surface.
struct PolygonizeOptions {
    float cell = 0;  ///< [m] side of a cell; 0: 1/64 of the longest side of the box
    int refinements =
        2;  ///< times a vertex is moved along its edge towards the surface after the first guess
};

template <class Self, class Visitor>
requires SameOptions<Self, PolygonizeOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(
        Field{"cell", "side of a cell of the polygonizer; 0 = 1/64 of the longest side", Unit::metre, 0, 1e6},
        o.cell);
    visit(
        Field{"refinements", "times a vertex is moved towards the surface along its edge", Unit::none, 0, 20},
        o.refinements);
}

/// The surface of a field as triangles: every cell is cut into six tetrahedra that match those of its
/// neighbours [Freudenthal1942], and every tetrahedron by at most two triangles. One vertex lies on each edge
/// that the surface crosses, so that the result is closed, manifold and free of self-intersections whatever
/// the field; where the solid reaches out of the box it is closed there, within one cell. Details smaller
/// than a cell may be lost. Empty when nothing is inside.
///
/// What the field says of a point must not depend on the other points of a call: InvalidInput where two calls
/// disagree on a point, as the surface would have a crack. The result has the same bits for any number of
/// threads. Every cell of the box is sampled: O((side / cell)^3). InvalidInput for more than 2,000,000 blocks
/// of 512 cells; Cancelled.
TriMesh polygonize(FieldRef field, const Box3& box, const PolygonizeOptions& options = {},
                   const Context& ctx = {});

/// Some of the blocks of 8 x 8 x 8 cells that a box is cut into: the regions of a field that has a list of
/// what matters in each.
struct PolygonizeRegions {
    std::vector<std::size_t> block;  ///< ascending: numbers of blocks, x fastest
    std::vector<Box3> box;           ///< of each
};

/// The blocks that touch one of the `near` boxes. O(blocks in all + blocks touched). InvalidInput for more
/// than 64,000,000 blocks in all, and as below.
PolygonizeRegions regions_touching(const Box3& box, std::span<const Box3> near,
                                   const PolygonizeOptions& options = {}, const Context& ctx = {});

/// The same as above, with the same options, where no block but those of `regions` holds anything of the
/// solid: the others are not sampled. Block i is sampled as region i of the field.
TriMesh polygonize(FieldRef field, const Box3& box, const PolygonizeRegions& regions,
                   const PolygonizeOptions& options = {}, const Context& ctx = {});

/// The same for a solid, in the box of its surface. Blocks whose range of values excludes the level are not
/// sampled: O((side / cell)^2) in the main.
TriMesh polygonize(const SolidField& field, const PolygonizeOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
