#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/ramification/tube_tree_internal.h"
#include "coppice/ramification/units_internal.h"

namespace coppice::ramification_internal {

/// The faces of a unit, where laterals may be pasted.
struct Seat {
    std::vector<std::uint32_t> quads;
    std::vector<std::uint32_t> pastes;  ///< the thickest first
};

/// A lateral that was grown on a stub of its own.
struct Paste {
    Lateral lateral;
    double diameter = 0;              ///< of the branch that it leaves
    double joint = 0;                 ///< along that one
    std::uint32_t parent = 0;         ///< that one
    std::uint32_t first_quad = 0;     ///< of the stub
    std::uint32_t quad_count = 0;     ///< of the stub
    std::uint32_t first_of_tube = 0;  ///< four quads whose first sides are the boundary of the lateral
};

/// The main mesh and the stubs, each closed, before subdivision.
///
/// A side becomes two tubes, named by the nodes of `tubes` in `region` and the next.
struct MainMesh {
    ControlMesh control;
    TubeTree tubes;  ///< that `region` names
    std::vector<Seat> seats;
    std::vector<Paste> pastes;
};

/// Builds units and tubes of all branches.
MainMesh build_main_mesh(const Branches& branches, const Skeleton& skeleton,
                         std::span<const NodeId> round_roots, const ControlOptions& ends, double alpha,
                         const RamificationOptions& options, RamificationReport& report, const Context& ctx);

}  // namespace coppice::ramification_internal
