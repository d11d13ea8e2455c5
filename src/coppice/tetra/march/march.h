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

/// Resolution of the surface and accuracy of its vertices.
struct MarchOptions {
    int levels = 2;  ///< number of subdivisions of every tetrahedron into eight
    /// [fine edges] vertices closer than this to the surface are moved onto it; 0 disables this
    float snap = 0.45f;
    /// number of corrections of a vertex along its edge towards the surface after the first estimate
    int refinements = 2;
};

/// Visits only the fields that determine the accuracy of the vertices.
void list_accuracy_fields(MarchOptions& o, FieldList& list);

/// Lists the members for front ends.
void list_fields(MarchOptions& o, FieldList& list);

/// Throws InvalidInput naming a field that is out of range.
void check(const MarchOptions& options);

/// Counts of a march.
struct MarchReport {
    std::uint64_t tetra = 0;     ///< of the finest level
    std::uint64_t vertices = 0;  ///< of the finest level, all sampled
    std::uint64_t inside = 0;    ///< of these, vertices with field values above the iso value
    std::uint64_t crossed = 0;   ///< tetrahedra of the finest level that the surface crosses
    std::uint64_t snapped = 0;   ///< vertices moved onto the surface
    std::uint64_t freed = 0;     ///< of the close vertices, those moved back to prevent folds and contacts
    std::uint64_t dropped = 0;   ///< removed components: closed ones without an axis inside, and hollows
    friend bool operator==(const MarchReport&, const MarchReport&) = default;  ///< member by member
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const MarchReport& r, Visitor&& visit) {
    visit("samples", r.vertices);
    visit("crossed_tetrahedra", r.crossed);
    visit("snapped_vertices", r.snapped);
    visit("freed_vertices", r.freed);
}

/// Lines that must be inside for any field and any size of tetrahedra: the axes from which the field was
/// made.
struct InsideAxes {
    std::span<const Segment> segments;             ///< [m] in the frame of the tetrahedra
    const CompressedRows<std::uint32_t>& passing;  ///< of each region at least those that pass through it
};

/// A surface of triangles and its report.
struct MarchResult {
    TriMesh mesh;     ///< [m] in the frame of the tetrahedra
    SolidMesh solid;  ///< the tetrahedra inside; empty except from march_solid
    std::vector<TetraFace>
        open;  ///< coarse hull faces, which belong to only one tetrahedron, that the surface passes through
    MarchReport report;  ///< counts
};

/// Extracts the surface value = level of a field within tetrahedra: marching tetrahedra on a mesh subdivided
/// by TetraRefinement. For any field the result is closed, manifold, oriented and free of self-intersections,
/// as far as rounding to float allows; details thinner than a fine edge may be lost.
///
/// Every fine vertex is sampled once. Vertices near the surface are moved onto it, which avoids short edges
/// and slivers [Labelle2007]. A vertex is not moved if a tetrahedron would be inverted or become flat, or if
/// two sheets of the surface would meet in it. Edges between inside and outside get a vertex where the field
/// crosses its iso value. Along edges, and along the gradient, the interpolated quantity is not the value but
/// (value / level)^0.4, which is linear for the compact quartic kernel, if the level is above 0. A sample
/// that is NaN is outside.
///
/// If the surface passes through the hull, that is, if a face that belongs to only one tetrahedron has fine
/// vertices on both sides, these faces are listed in `open`, ascending, and the mesh and its counts are left
/// empty. A hull that is entirely inside, such as the inner hull of a shell, is not an error.
///
/// Each region of the mesh is sampled with its number. The result does not depend on the number of threads.
/// Throws InvalidInput for options out of range and for input that TetraRefinement rejects. O(fine
/// tetrahedra); 4 bytes per fine vertex and about 200 per coarse tetrahedron in addition to the result.
MarchResult march(const TetraMesh& mesh, FieldRef field, const MarchOptions& options = {},
                  const Context& ctx = {});

/// Extracts the surface around axes, each of which is inside one component of the surface. Connected axes are
/// in the same component, so there is one component for each connected set of axes, or fewer where sets are
/// so close to each other that the tetrahedra do not separate them. There are no other components: closed
/// components without an axis inside, and hollows, are removed. The tetrahedra must cover all axes.
///
/// Where the field is not above its iso value around an axis, or where tetrahedra are too large to resolve
/// it, the surface has the radius of the segment around a corner of the tetrahedra near the axis, or half an
/// edge if that is less; such corners are moved towards the axis.
MarchResult march(const TetraMesh& mesh, FieldRef field, const InsideAxes& axes,
                  const MarchOptions& options = {}, const Context& ctx = {});

/// Also creates the fine tetrahedra inside. Those that the surface crosses are cut such that all tetrahedra
/// share whole faces, and the unshared faces are the triangles of the surface. Vertices of the surface come
/// first, in the same order. Hull faces that are inside are also listed in `open`, and hollows are kept.
/// About 40 additional bytes for each fine tetrahedron inside.
MarchResult march_solid(const TetraMesh& mesh, FieldRef field, const InsideAxes& axes,
                        const MarchOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
