#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/context.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// What smoothing did to quads that cross.
struct SmoothedCrossings {
    std::uint64_t pairs_before = 0;
    std::uint64_t pairs_after = 0;
    std::uint32_t rounds = 0;
};

/// Smooths a closed mesh where its quads cross, like a soap film between what stays, until none do or after
/// so many rounds; each takes a little more about what still crosses. The first `fixed` quads ... Keeps the
/// state with the fewest pairs. A clean mesh keeps its bits. O(n) and the search for crossings.
SmoothedCrossings smooth_crossings(QuadMesh& mesh, std::span<const ClipPlane> clips, int quads_of_cage_quad,
                                   int rounds, const Context& ctx);

}  // namespace coppice
