#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/cage/cage.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options of the connection of branches by ramification units.
struct RamificationOptions {
    bool all_additional = false;              ///< paste every lateral; none is part of the main mesh
    bool no_connection_optimisation = false;  ///< units remain cubes, even if neighbours overlap
    /// angles of siblings modulo 45 degrees, as printed: 90 and 180 are additional
    bool printed_angles = false;
    float additional_threshold = 3;  ///< T_add: units with a higher connection cost are merged
};

/// Lists the members for front ends.
void list_fields(RamificationOptions& o, FieldList& list);

/// Objective of [Huang2017] eq. 1, in its three sums.
struct RamificationObjective {
    double units = 0;        ///< RU, sum over all units
    double connections = 0;  ///< RC, sum over neighbours along a branch
    double pastes = 0;       ///< CP, sum over pasted laterals

    double total() const { return units + connections + pastes; }  ///< f
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const RamificationObjective& r, Visitor&& visit) {
    visit("units", r.units);
    visit("connections", r.connections);
    visit("pastes", r.pastes);
    visit("total", r.total());
}

/// Counts and objective of the construction.
struct RamificationReport {
    std::uint32_t branches = 0;      ///< number of axes
    std::uint32_t units = 0;         ///< number of units, where laterals leave a branch
    std::uint32_t connectable = 0;   ///< number of laterals that are part of the main mesh
    std::uint32_t additional = 0;    ///< number of laterals that were pasted
    std::uint32_t crowded = 0;       ///< number of these in a single face, because space was missing
    RamificationObjective before;    ///< for cubes and the initial loops
    RamificationObjective after;     ///< for the optimised units and the rotated and moved loops
    double connection_seconds = 0;   ///< [s] branches, units and main mesh
    double subdivision_seconds = 0;  ///< [s] first subdivision
    double paste_seconds = 0;        ///< [s] cut and paste
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const RamificationReport& r, Visitor&& visit) {
    visit("branches", r.branches);
    visit("units", r.units);
    visit("connectable", r.connectable);
    visit("additional", r.additional);
    visit("crowded", r.crowded);
    visit("objective_before", r.before);
    visit("objective_after", r.after);
    visit("connection_seconds", r.connection_seconds);
    visit("subdivision_seconds", r.subdivision_seconds);
    visit("paste_seconds", r.paste_seconds);
}

/// Control mesh after one subdivision, and the report.
struct RamificationMesh {
    ControlMesh control;  ///< as of build_control_mesh, for one level less; regions are nodes of `tubes`
    Skeleton tubes;       ///< nodes at the middles of units, at each ring of quads and at each end
    std::vector<std::array<float, 2>>
        sides;                        ///< per node of `tubes`: parameter range of its quads on the axis
    CompressedRows<NodeId> wrapping;  ///< per node of the skeleton: the tubes about its segment, in order
    RamificationReport report;        ///< counts and objective
};

/// Wraps a skeleton in quads by ramification units [Huang2017], subdivided once by Catmull-Clark: closed,
/// manifold and oriented for every skeleton, one sphere per tree.
///
/// A branch continues at each node with the child that is thick and straight on. It is a tube of four quads
/// around, with a ring at each node. Where laterals leave it the tube has a unit, a cube about the exit of
/// the axis of the lateral, rotated so that the exit is in the middle of a face; a connectable lateral begins
/// in such a face. Laterals with an exit near an edge of the cube, or at an occupied face, are additional:
/// they are built separately on a unit of their own, subdivided, separated from its face and pasted into the
/// main mesh, replacing the faces about the vertex closest to the intersection with their axis, or one face
/// if siblings leave no more. A band of quads is added between them if the place is wider than the lateral.
/// Adjacent units divide the space between them so that RU + RC is minimal; if it remains above
/// `additional_threshold` or their faces overlap, they are merged into one unit.
///
/// Of `ends`, the number of sides is always 4 and the base is never open. `levels` is the total number of
/// subdivisions that the widths of branches compensate for. Throws InvalidInput for an open base. Trees have
/// round ends at `round_roots` (ascending). O(n log n); the result is deterministic.
RamificationMesh build_ramifications(const Skeleton& skeleton, const ControlOptions& ends, int levels,
                                     const RamificationOptions& options = {}, const Context& ctx = {},
                                     std::span<const NodeId> round_roots = {});

}  // namespace coppice
