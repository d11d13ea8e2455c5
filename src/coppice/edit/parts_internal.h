#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/edit/editable_tree.h"

namespace coppice::edit_internal {

inline Vec3d place_of(const EditableTree& tree, StableId n) { return Vec3d(tree.position(n)); }

inline bool holds(const NodeSet& set, StableId n) { return std::ranges::binary_search(set, n); }

/// Throws where a set is empty or names nodes that are not there.
void check_set(const EditableTree& tree, const NodeSet& set);

/// The nodes of a set that hang on no other one of it.
std::vector<StableId> tops_of(const EditableTree& tree, const NodeSet& set);

/// The joint that a node leaves from: its parent, or itself where it is a root.
inline StableId joint_of(const EditableTree& tree, StableId n) {
    return tree.is_root(n) ? n : tree.parent(n);
}

/// The direction in which a node is reached; of a root, in which its leader leaves.
Vec3d direction_of(const EditableTree& tree, StableId n);

/// Whether n is `top` or hangs on it. O(depth).
bool hangs_on(const EditableTree& tree, StableId n, StableId top);

/// The part of the axis of a node that is tipward of it, from the node itself.
std::vector<StableId> axis_from(const EditableTree& tree, StableId n);

/// A new node on the segment that ends at n, with the radius that the segment has there, so that the surface
/// stays as it is; t in (0, 1) from the parent.
StableId split_segment(TreeEdit& edit, const EditableTree& tree, StableId n, double t);

/// Lets no radius of a subtree exceed a limit.
void limit_radii(TreeEdit& edit, const EditableTree& tree, StableId top, float limit);

/// A point of a tree's axes.
struct Foot {
    StableId node;        ///< end of its segment; a root without segments for a ball; none: nothing was found
    double t = 1;         ///< where on the segment, 1 at the node
    Vec3d place;          ///< [m] local
    double distance = 0;  ///< [m]
    double radius = 0;    ///< [m] of the wood there
};

Foot foot_on(const EditableTree& tree, StableId n, Vec3d p);

/// The point of all axes that is nearest to p, of nodes that `counts` holds of. O(n).
template <class Counts>
Foot nearest_foot(const EditableTree& tree, Vec3d p, const Counts& counts) {
    Foot best;
    for (const StableId n : tree.nodes()) {
        if (!counts(n) || (tree.is_root(n) && !tree.is_tip(n))) continue;
        const Foot foot = foot_on(tree, n, p);
        if (!best.node || foot.distance < best.distance) best = foot;
    }
    return best;
}

/// The node at a foot: that of an end that is within a fifth of the radius, else a new one.
StableId node_at(TreeEdit& edit, const EditableTree& tree, const Foot& foot);

}  // namespace coppice::edit_internal
