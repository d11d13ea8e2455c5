#pragma once

#include <cstdint>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// An edited skeleton, and what became of the nodes.
struct EditResult {
    Skeleton skeleton;               ///< the new one
    std::uint32_t count = 0;         ///< what was changed: see each function
    std::vector<NodeId> new_of_old;  ///< per old node: the one that stands for it
};

/// Averages radii along axes: a node keeps half of its radius and takes a quarter each of its parent's and
/// its leader's. Tips, roots and the first nodes of laterals stay, and so does which child leads. `count`:
/// radii that changed. O(n passes).
EditResult smooth_radii(const Skeleton& skeleton, int passes);

/// Makes one of a branch node and the next branch node rootward of it where they are nearer than `factor`
/// times the larger radius: the thicker one stays in place (the one nearer to the root on ties) and has the
/// children of both; nodes between them go. `count`: branch nodes that went. Tips and roots stay. O(n).
EditResult merge_close_branches(const Skeleton& skeleton, float factor = 0.5f);

/// Splits nodes with more than `max_children` >= 2 children: new nodes along the first half of the leader's
/// segment, at most a radius apart, take over the children, those that point most forward last. `count`: new
/// nodes. Throws InvalidInput when max_children < 2. O(n log n).
EditResult split_crowded_nodes(const Skeleton& skeleton, int max_children);

}  // namespace coppice
