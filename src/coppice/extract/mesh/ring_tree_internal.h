#pragma once

#include <utility>
#include <vector>

#include "coppice/extract/mesh/rings_internal.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {

struct RingTree {
    InitialTree tree;
    std::vector<std::uint32_t> node_of_ring;  ///< of removed rings: the node of the next one outward
    std::vector<std::pair<std::uint32_t, std::uint32_t>> loops;  ///< tips and the nodes that they touch
};

/// Connects the rings to axes. Rings distorted by a fork are removed, and each chain begins where its axis
/// meets the axis of its parent. O(rings) for a bounded number of chains per ring.
RingTree connect_rings(const Surface& surface, const RingForest& forest);

}  // namespace coppice::extract_internal
