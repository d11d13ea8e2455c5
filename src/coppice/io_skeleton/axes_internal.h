#pragma once

#include <cstdint>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// An axis: the path from a node that does not continue its parent's axis along the leaders to a tip.
struct SkeletonAxis {
    NodeId first;             ///< a root, or a child that is not the leader of its parent
    std::uint32_t order = 0;  ///< number of axes between this one and the root
    std::uint32_t place = 0;  ///< index of the branching node in its parent axis, from 0
};

/// Returns the axes of all trees in depth-first order: an axis precedes its laterals, which follow in the
/// order of their branching nodes, each with its own laterals. O(n), not recursive.
std::vector<SkeletonAxis> find_axes(const Skeleton& skeleton);

/// Returns whether traversing the axes in the order of find_axes() visits the nodes in the order of their
/// ids.
bool is_in_order_of_axes(const Skeleton& skeleton, const std::vector<SkeletonAxis>& axes);

}  // namespace coppice
