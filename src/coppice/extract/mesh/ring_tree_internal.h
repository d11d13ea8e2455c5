#pragma once

#include <utility>
#include <vector>

#include "coppice/extract/mesh/rings_internal.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

struct RingTree {
    DraftTree tree;
    std::vector<std::uint32_t> node_of_ring;                     ///< of rings left out: the next one outward
    std::vector<std::pair<std::uint32_t, std::uint32_t>> loops;  ///< tips, and the nodes that they touch
};

/// Connects the rings to axes: those that a fork has spoilt are left out, and each chain begins on the axis
/// of the one it leaves, where its own axis meets that. O(rings), for a bounded number of chains per ring.
RingTree connect_rings(const Surface& surface, const RingForest& forest);

}  // namespace coppice::extract_internal
