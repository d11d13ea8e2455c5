#pragma once

#include <span>
#include <vector>

#include "coppice/cage/frame_internal.h"

namespace coppice::cage_internal {

/// A segment as seen from the node at which it begins.
struct Branch {
    Vec3 direction;  ///< unit, away from the node
    float radius;    ///< [m] at the node
    float length;    ///< [m]
};

/// The cage around one branch node: vertices, and the ring with which each branch begins.
struct Hub {
    std::vector<Vec3> position;  ///< [m] relative to the node
    std::vector<Vec3> anchor;    ///< [m] relative to the node; if empty, the node for all vertices
    std::vector<Ring> quads;     ///< between the cells
    std::vector<Ring> cell;      ///< per branch: counter-clockwise about its direction; local vertex indices
};

/// Divides the surface around a node among its branches: three or more. `stem` is the branch that leads to
/// the parent, `leader` the one that continues it; for a node without a parent, they are any two. O(k^3) for
/// k branches, linear beyond 256.
Hub build_hub(std::span<const Branch> branches, std::uint32_t stem, std::uint32_t leader);

}  // namespace coppice::cage_internal
