#pragma once

#include <cstdint>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A run of nodes from one that leads no parent along the leaders to a tip.
struct SkeletonAxis {
    NodeId first;             ///< a root, or a child that does not lead its parent
    std::uint32_t order = 0;  ///< how many axes it stands on
    std::uint32_t place = 0;  ///< which node of the axis it leaves bears it, from 0
};

/// The axes of all trees: an axis comes before those that leave it, and these follow in the order in which
/// they leave, each with all of its own. O(n), no recursion.
std::vector<SkeletonAxis> axes_of(const Skeleton& skeleton);

/// Whether going along the axes, as axes_of() has them, meets the nodes in the order of their ids.
bool is_in_order_of_axes(const Skeleton& skeleton, const std::vector<SkeletonAxis>& axes);

}  // namespace coppice
