#pragma once

#include <optional>

#include "coppice/compose/child_tree.h"

namespace coppice {

/// A point on an axis of a tree.
struct ParentPlace {
    Vec3d position;     ///< [m] from the skeleton's origin
    Vec3d direction;    ///< unit vector; direction in which the axis arrives there; up at a root
    double radius = 0;  ///< [m] radius of the branch
};

/// Returns the point at the parameter `along` of the segment that ends at a node, 1 at the node; for a root,
/// the root itself.
ParentPlace find_parent_place(const Skeleton& tree, NodeId node, double along = 1);

/// Direction, roll and scale of an inserted child tree.
struct BranchPose {
    /// Initial direction, of any length except 0. If absent: the inclination of the child tree to its
    /// original parent branch, towards the side with the most free space.
    std::optional<Vec3d> direction;
    double roll = 0;   ///< [rad] rotation about the direction
    double scale = 1;  ///< factor on lengths and radii; > 0
};

/// Returns a child tree positioned on a parent branch: its root is at the place, in coordinates relative to
/// the origin of the tree, with its own radii. If the parent branch is thicker than the original one, the
/// first segment is longer by the difference, because forks inside a branch create intersecting surfaces.
/// Throws InvalidInput if the direction is zero. O(n), for both trees.
Skeleton placed_branch(const ChildTree& branch, const Skeleton& tree, const ParentPlace& place,
                       const BranchPose& pose = {});

}  // namespace coppice
