#pragma once

#include <cstdint>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/statistics.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options of the search for the original surface.
struct RestoreOptions {
    float reach = 0.5f;    ///< [radii] maximum distance of the original from a vertex, in both directions
    int fade_passes = 20;  ///< approximate number of rings of vertices over which offsets fade
};

/// Lists the members for front ends.
void list_fields(RestoreOptions& o, FieldList& list);

/// Counts of `restore_offsets`.
struct RestoreReport {
    std::uint64_t found = 0;        ///< vertices with the original within reach
    std::uint64_t faded = 0;        ///< vertices without, which move with their neighbours
    std::uint64_t pulled_back = 0;  ///< vertices that moved less to avoid folded or intersecting faces
    std::uint32_t rounds = 0;       ///< rounds that limited displacements
    bool turned = false;            ///< whether inward faces of the original were reversed
    Statistics offset;              ///< [radii] displacement of all vertices; outward is positive
    Statistics distance_before;  ///< [radii] distance from vertices to the original; empty if none was found
    Statistics distance_after;   ///< [radii] offsets of the same vertices
    friend bool operator==(const RestoreReport&, const RestoreReport&) = default;  ///< memberwise
};

/// Displacement of each vertex, and the report.
struct RestoreResult {
    Buffer<float> offsets;  ///< [m] per vertex, along its previous normal: mean of its faces by area
    RestoreReport report;   ///< counts and statistics
};

/// Moves the vertices of a surface along their normals onto the original from which its skeleton was
/// extracted, to restore details that a skeleton cannot represent: bark, burls, trunks that are not round
/// [Zhu2015], section 4.4.
///
/// Each vertex moves to the closest intersection of its normal with a face of the original of the same
/// orientation, within `reach` local radii (those of `skeleton` nearby; a tree of one node has no radii and
/// does not move). Without an intersection, as over holes, offsets are averaged over neighbours and fade. At
/// faces that would fold, and pairs that would intersect and did not before, the offsets are reduced by
/// halves, then to zero: the surface has no additional folds or intersections. Only positions change.
///
/// If more vertices find the original with its components turned outward, as `clean_mesh` does, than as it
/// is, it is turned. It may be open, in several components or empty, and have its own origin. O(n log m) for
/// n vertices and m faces of the original; about 300 bytes of additional memory per vertex. The result does
/// not depend on the number of threads. Throws InvalidInput naming an option out of range, the defect of
/// either mesh, or that the surface intersects itself too often to separate new intersections from existing
/// ones.
RestoreResult restore_offsets(QuadMesh& mesh, const PolygonMesh& original, const Skeleton& skeleton,
                              const RestoreOptions& options = {}, const Context& ctx = {});

/// Calls visit(name, value) for every figure; statistics have figures of their own.
template <class Visitor>
void visit_figures(const RestoreReport& r, Visitor&& visit) {
    visit("found", r.found);
    visit("faded", r.faded);
    visit("pulled_back", r.pulled_back);
    visit("rounds", r.rounds);
    visit("turned", r.turned);
    visit("offset", r.offset);
    visit("distance_before", r.distance_before);
    visit("distance_after", r.distance_after);
}

}  // namespace coppice
