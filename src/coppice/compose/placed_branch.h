#pragma once

#include <optional>

#include "coppice/compose/child_tree.h"

namespace coppice {

/// A place on the axes of a tree.
struct HostPlace {
    Vec3d position;     ///< [m] from the skeleton's origin
    Vec3d direction;    ///< unit; in which the axis arrives there; up at a root
    double radius = 0;  ///< [m] of the wood
};

/// A place on the segment that ends at a node, 1 = at the node; at a root the root itself.
HostPlace host_place(const Skeleton& tree, NodeId node, double along = 1);

/// How a child tree is put there.
struct BranchPose {
    /// Where it sets off to, of any length but 0. Without: as inclined to its host as on its own, to the side
    /// with most room.
    std::optional<Vec3d> direction;
    double roll = 0;   ///< [rad] about that
    double scale = 1;  ///< of lengths and radii; > 0
};

/// A child tree as it stands on a host: its root at the place, in the coordinates of the tree's origin, with
/// its own radii. On a thicker host than its own its first segment is as much longer, as forks within the
/// wood make surfaces that cross. Throws InvalidInput for a direction without length. O(n), of both.
Skeleton placed_branch(const ChildTree& branch, const Skeleton& tree, const HostPlace& host,
                       const BranchPose& pose = {});

}  // namespace coppice
