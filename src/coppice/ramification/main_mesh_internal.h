#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/ramification/tube_tree_internal.h"
#include "coppice/ramification/units_internal.h"

namespace coppice::ramification_internal {

/// Faces of a unit on which laterals may be pasted.
struct Seat {
    std::vector<std::uint32_t> quads;
    std::vector<std::uint32_t> pastes;  ///< thickest first
};

/// Lateral that was built on a separate stub.
struct Paste {
    Lateral lateral;
    double diameter = 0;              ///< diameter of the parent branch
    double joint = 0;                 ///< arc length along the parent branch
    std::uint32_t parent = 0;         ///< parent branch
    std::uint32_t first_quad = 0;     ///< first quad of the stub
    std::uint32_t quad_count = 0;     ///< number of quads of the stub
    std::uint32_t first_of_tube = 0;  ///< four quads with first sides on the boundary of the lateral
};

/// Main mesh and stubs, each closed, before subdivision.
///
/// A side becomes two tubes: the node of `tubes` in `region`, and the next one.
struct MainMesh {
    ControlMesh control;
    TubeTree tubes;  ///< nodes that `region` refers to
    std::vector<Seat> seats;
    std::vector<Paste> pastes;
};

/// Builds units and tubes of all branches.
MainMesh build_main_mesh(const Branches& branches, const Skeleton& skeleton,
                         std::span<const NodeId> round_roots, const ControlOptions& ends, double alpha,
                         const RamificationOptions& options, RamificationReport& report, const Context& ctx);

}  // namespace coppice::ramification_internal
