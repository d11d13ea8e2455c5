#pragma once

#include <cstdint>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// An edited skeleton and the map from its old nodes.
struct EditResult {
    Skeleton skeleton;               ///< edited skeleton
    std::uint32_t count = 0;         ///< number of changes: see each function
    std::vector<NodeId> new_of_old;  ///< by old node: the new node that replaces it
};

/// Averages radii along axes: the new radius of a node is half of its own plus a quarter of its parent's and
/// of its leader's. Radii of tips, roots and first nodes of laterals are unchanged, and so are the leaders.
/// `count`: radii that changed. O(n passes).
EditResult smooth_radii(const Skeleton& skeleton, int passes);

/// Merges a branch node with the next one towards the root if their distance is less than `factor` times the
/// larger radius: the thicker one keeps its position (the one closer to the root on ties) and gets the
/// children of both; nodes between them are removed. `count`: removed branch nodes. Tips and roots are
/// preserved. O(n).
EditResult merge_close_branches(const Skeleton& skeleton, float factor = 0.5f);

/// Splits nodes with more than `max_children` >= 2 children: inserts nodes in the first half of the leader's
/// segment, at most a radius apart, and distributes the children to them, those that point forward most last.
/// `count`: new nodes. Throws InvalidInput if max_children < 2. O(n log n).
EditResult split_crowded_nodes(const Skeleton& skeleton, int max_children);

}  // namespace coppice
