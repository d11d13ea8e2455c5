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

/// How branches are joined by ramification units.
struct RamificationOptions {
    bool all_additional = false;              ///< every lateral is pasted, none is part of the main mesh
    bool no_connection_optimisation = false;  ///< units stay cubes, also where neighbours overlap
    bool printed_angles =
        false;  ///< angles of siblings modulo 45 degrees, as printed: 90 and 180 are additional
    float additional_threshold = 3;  ///< T_add: units whose connection costs more become one
};

template <class Self, class Visitor>
requires SameOptions<Self, RamificationOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"all_additional", "paste every lateral instead of making most of them part of the main mesh"},
          o.all_additional);
    visit(
        Field{"no_connection_optimisation", "leave ramification units cubes, also where neighbours overlap"},
        o.no_connection_optimisation);
    visit(
        Field{"printed_angles",
              "take angles between siblings modulo 45 degrees as printed, so that only one of them connects"},
        o.printed_angles);
    visit(Field{"additional_threshold", "cost of a connection above which two ramification units become one",
                Unit::none, 0, 100},
          o.additional_threshold);
}

/// The objective of [Huang2017] eq. 1, in its three sums; see objective.h.
struct RamificationObjective {
    double units = 0;        ///< RU, of all units
    double connections = 0;  ///< RC, of neighbours along a branch
    double pastes = 0;       ///< CP, of laterals that were pasted

    double total() const { return units + connections + pastes; }  ///< f
};

/// What was built, and how well it fits.
struct RamificationReport {
    std::uint32_t branches = 0;      ///< axes
    std::uint32_t units = 0;         ///< places where laterals leave a branch
    std::uint32_t connectable = 0;   ///< laterals that are part of the main mesh
    std::uint32_t additional = 0;    ///< laterals that were pasted
    std::uint32_t crowded = 0;       ///< of these, pasted into a single face for want of room
    RamificationObjective before;    ///< of cubes, and of loops as they come
    RamificationObjective after;     ///< of the units, and of loops turned and moved
    double connection_seconds = 0;   ///< branches, units and main mesh
    double subdivision_seconds = 0;  ///< first subdivision
    double paste_seconds = 0;        ///< cut and paste
};

/// A control mesh, once subdivided, and what was built.
struct RamificationMesh {
    ControlMesh control;  ///< as of build_control_mesh, for one level less; regions are nodes of `tubes`
    Skeleton tubes;       ///< nodes at the middles of units, at each ring of quads and at each end
    std::vector<std::array<float, 2>>
        sides;  ///< per node of `tubes`: between which parameters of the tube's axis its quads lie
    CompressedRows<NodeId> wrapping;  ///< per node of the skeleton: the tubes about its segment, in order
    RamificationReport report;        ///< counts
};

/// Wraps a skeleton in quads by ramification units [Huang2017], once subdivided by Catmull-Clark: closed,
/// manifold and oriented for every skeleton, one sphere per tree.
///
/// A branch follows at each node the child that is thick and straight on. It is a tube of four quads around,
/// with a ring at each node. Where laterals leave it the tube has a unit, a cube about the place where the
/// lateral's axis comes out, turned so that this is the middle of a face; a lateral that is connectable
/// begins in such a face. Laterals that come out near an edge of the cube, or at a face that is taken, are
/// additional: they are grown apart on a unit of their own, subdivided, cut off at its face and pasted into
/// the main mesh, in place of the faces about the vertex next to where their axis meets it, or of one face
/// where siblings leave no more. A band of quads lies between where the place is wider than the lateral.
/// Neighbouring units share the space between them so that RU + RC is least; where it stays above
/// `additional_threshold` or their faces overlap, they become one unit.
///
/// Of `ends`, sides are always 4 and the base is never open.
/// `levels` says for how many subdivisions in all branches are made wider. Throws InvalidInput for an open
/// base. Trees end round at `round_roots` (ascending). O(n log n); the same bits always.
RamificationMesh build_ramifications(const Skeleton& skeleton, const ControlOptions& ends, int levels,
                                     const RamificationOptions& options = {}, const Context& ctx = {},
                                     std::span<const NodeId> round_roots = {});

}  // namespace coppice
