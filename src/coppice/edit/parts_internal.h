#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/edit/editable_tree.h"

namespace coppice::edit_internal {

inline Vec3d get_position(const EditableTree& tree, StableId n) { return Vec3d(tree.position(n)); }

inline bool holds(const NodeSet& set, StableId n) { return std::ranges::binary_search(set, n); }

/// Throws InvalidInput if a set is empty or contains nodes that do not exist.
void check_set(const EditableTree& tree, const NodeSet& set);

/// Returns the nodes of a set without an ancestor in it.
std::vector<StableId> find_tops(const EditableTree& tree, const NodeSet& set);

/// Returns the joint of a branch: the parent of its first node, or the node itself if it is a root.
inline StableId find_joint(const EditableTree& tree, StableId n) {
    return tree.is_root(n) ? n : tree.parent(n);
}

/// Returns the direction of the segment that ends at a node; for a root, of the segment to its leader.
Vec3d compute_direction(const EditableTree& tree, StableId n);

/// Returns whether n is `top` or a descendant of it. O(depth).
bool hangs_on(const EditableTree& tree, StableId n, StableId top);

/// Returns the section of the axis of a node from the node to the tip.
std::vector<StableId> axis_from(const EditableTree& tree, StableId n);

/// Inserts a node into the segment that ends at n, with the radius of the segment there, so that the surface
/// is unchanged; t in (0, 1) from the parent.
StableId split_segment(TreeEdit& edit, const EditableTree& tree, StableId n, double t);

/// Limits the radii of a subtree.
void limit_radii(TreeEdit& edit, const EditableTree& tree, StableId top, float limit);

/// A point on an axis of a tree.
struct ClosestPoint {
    StableId node;  ///< end of its segment; a root without segments for a ball; none if no point was found
    double t = 1;   ///< parameter on the segment, 1 at the node
    Vec3d place;    ///< [m] local
    double distance = 0;  ///< [m]
    double radius = 0;    ///< [m] of the branch there
};

ClosestPoint closest_point_on_segment(const EditableTree& tree, StableId n, Vec3d p);

/// Returns the closest point to p on all axes, among the nodes for which `counts` returns true. O(n).
template <class Counts>
ClosestPoint find_closest_point(const EditableTree& tree, Vec3d p, const Counts& counts) {
    ClosestPoint best;
    for (const StableId n : tree.nodes()) {
        if (!counts(n) || (tree.is_root(n) && !tree.is_tip(n))) continue;
        const ClosestPoint closest = closest_point_on_segment(tree, n, p);
        if (!best.node || closest.distance < best.distance) best = closest;
    }
    return best;
}

/// Returns the node at a point of an axis: an end of the segment within a fifth of the radius, otherwise a
/// new node.
StableId node_at(TreeEdit& edit, const EditableTree& tree, const ClosestPoint& closest);

}  // namespace coppice::edit_internal
