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

/// Options of polygonize().
struct PolygonizeOptions {
    float cell = 0;       ///< [m] side of a cell; 0: 1/64 of the longest side of the box
    int refinements = 2;  ///< number of times that a vertex is moved along its edge towards the surface after
                          ///< the first estimate
};

/// Lists the members for front ends.
void list_fields(PolygonizeOptions& o, FieldList& list);

/// Returns the surface of a field as triangles: every cell is divided into six tetrahedra that match those of
/// its neighbours [Freudenthal1942], and every tetrahedron contains at most two triangles. There is one
/// vertex on each edge that the surface crosses, so that the result is closed, manifold and free of
/// self-intersections for any field; where the solid extends beyond the box it is closed there, within one
/// cell. Features smaller than a cell may be lost. Empty if no node is inside.
///
/// The value at a point must not depend on the other points of a call: throws InvalidInput if two calls
/// disagree on a point, because the surface would have a crack. The result does not depend on the number of
/// threads (bit-identical). Every cell of the box is sampled: O((side / cell)^3). Throws InvalidInput for
/// more than 2,000,000 blocks of 512 cells; Cancelled.
TriMesh polygonize(FieldRef field, const Box3& box, const PolygonizeOptions& options = {},
                   const Context& ctx = {});

/// A subset of the blocks of 8 x 8 x 8 cells into which a box is divided: the regions of a field with a list
/// of relevant elements for each.
struct PolygonizeRegions {
    std::vector<std::size_t> block;  ///< sorted indices of blocks, x fastest
    std::vector<Box3> box;           ///< of each block
};

/// Returns the blocks that touch one of the `near` boxes. O(total blocks + touched blocks). Throws
/// InvalidInput for more than 64,000,000 blocks in total, and as below.
PolygonizeRegions regions_touching(const Box3& box, std::span<const Box3> near,
                                   const PolygonizeOptions& options = {}, const Context& ctx = {});

/// The same as above, with the same options, if only the blocks of `regions` contain a portion of the solid:
/// the others are not sampled. Block i is sampled as region i of the field.
TriMesh polygonize(FieldRef field, const Box3& box, const PolygonizeRegions& regions,
                   const PolygonizeOptions& options = {}, const Context& ctx = {});

/// The same for a solid, in the box of its surface. Blocks with a range of values that excludes the iso value
/// are not sampled: mostly O((side / cell)^2).
TriMesh polygonize(const SolidField& field, const PolygonizeOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
