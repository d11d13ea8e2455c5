#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/solid_mesh.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

namespace coppice {

/// How fine the surface is, and how exactly its vertices lie on it.
struct MarchOptions {
    int levels = 2;      ///< times every tetrahedron is cut into eight
    float snap = 0.45f;  ///< [fine edges] vertices nearer than this to the surface are moved onto it; 0: none
    int refinements =
        2;  ///< times a vertex is moved along its edge towards the surface after the first guess
};

/// Those of how exactly the vertices lie, alone.
template <class Self, class Visitor>
requires SameOptions<Self, MarchOptions>
constexpr void visit_accuracy_fields(Self& o, Visitor&& visit) {
    visit(Field{"snap", "corners of tetrahedra nearer to the surface than this part of an edge move onto it",
                Unit::none, 0, 0.5},
          o.snap);
    visit(
        Field{"refinements", "times a vertex is moved towards the surface along its edge", Unit::none, 0, 20},
        o.refinements);
}

template <class Self, class Visitor>
requires SameOptions<Self, MarchOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"levels", "times every tetrahedron is cut into eight", Unit::none, 0, 5}, o.levels);
    visit_accuracy_fields(o, visit);
}

/// Throws InvalidInput naming a field that is out of range.
void check(const MarchOptions& options);

/// How marching went, counted.
struct MarchReport {
    std::uint64_t tetra = 0;     ///< of the finest level
    std::uint64_t vertices = 0;  ///< of the finest level, all sampled
    std::uint64_t inside = 0;    ///< of these, those where the field is above its level
    std::uint64_t crossed = 0;   ///< tetrahedra of the finest level that the surface crosses
    std::uint64_t snapped = 0;   ///< vertices moved onto the surface
    std::uint64_t freed = 0;     ///< of those near enough, put back so that nothing folds or touches
    std::uint64_t dropped = 0;   ///< closed parts without an axis inside, and hollows, that were left out
    friend bool operator==(const MarchReport&, const MarchReport&) = default;  ///< member by member
};

/// Lines of which all is to be inside, whatever the field says and however coarse the tetrahedra are: the
/// axes of what the field was made of.
struct InsideAxes {
    std::span<const Segment> segments;             ///< [m] in the frame of the tetrahedra
    const CompressedRows<std::uint32_t>& passing;  ///< of each region at least those that pass through it
};

/// A surface of triangles, and the report.
struct MarchResult {
    TriMesh mesh;                 ///< [m] in the frame of the tetrahedra
    SolidMesh solid;              ///< what is inside; empty but from march_solid
    std::vector<TetraFace> open;  ///< coarse faces of one tetrahedron alone that the surface passes through
    MarchReport report;           ///< what was done
};

/// The surface value = level of a field within tetrahedra: marching tetrahedra on a mesh subdivided by
/// TetraRefinement. Closed, manifold, oriented and free of self-intersections whatever the field, as far as
/// rounding to float allows; what is thinner than a fine edge may be lost.
///
/// Every fine vertex is sampled once. Those near the surface are moved onto it, so that neither short edges
/// nor slivers arise [Labelle2007]. A vertex is left where it was if a tetrahedron would turn over or become
/// flat, or if two sheets of the surface would meet in it. Edges between inside and outside get a vertex
/// where the field crosses its level. Along edges, and along the gradient, it is not the value that is
/// followed but (value / level)^0.4, a straight line for the compact quartic kernel, where the level is above
/// 0. A sample that is not a number is outside.
///
/// Where the surface passes through the hull, that is, where a face that belongs to one tetrahedron alone has
/// fine vertices on both sides, these faces are named in `open`, ascending, and the mesh and what the report
/// says of it are left empty. A hull that is inside as a whole, such as the inner one of a shell, is no
/// fault.
///
/// Each region of the mesh is sampled with its number. Deterministic for any number of threads. Throws
/// InvalidInput for options out of range and for what TetraRefinement refuses. O(fine tetrahedra); 4 bytes
/// per fine vertex and some 200 per coarse tetrahedron besides the result.
MarchResult march(const TetraMesh& mesh, FieldRef field, const MarchOptions& options = {},
                  const Context& ctx = {});

/// The same about axes, each of which comes to lie in one part of the surface: connected ones in the same, so
/// that there is a part for each connected set of axes, or fewer where sets come so near to each other that
/// the tetrahedra do not tell them apart. There are no others: closed parts without an axis inside, and
/// hollows, are left out. The tetrahedra must cover all axes.
///
/// Where the field is not above its level about an axis, or where tetrahedra are too large to see that it is,
/// the surface has the radius of the segment about a corner of the tetrahedra near the axis, or half an edge
/// where that is less; such corners are moved towards the axis.
MarchResult march(const TetraMesh& mesh, FieldRef field, const InsideAxes& axes,
                  const MarchOptions& options = {}, const Context& ctx = {});

/// The same, and the fine tetrahedra inside, those that the surface crosses cut so that all share whole
/// faces and the triangles of the surface are what is left over. Vertices of the surface come first, in the
/// same order. Faces of the hull that are inside are `open`, too, and hollows stay. Some 40 bytes more for
/// each fine tetrahedron inside.
MarchResult march_solid(const TetraMesh& mesh, FieldRef field, const InsideAxes& axes,
                        const MarchOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
