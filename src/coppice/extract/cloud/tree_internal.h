#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/id.h"
#include "coppice/base/vec.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {

/// Tree during the extraction, with the node of each point. A radius of 0 is not known yet.
struct CloudTree : InitialTree {
    std::vector<float> weight;            ///< weight of the radius: number of points of the fit, 0 = none
    std::vector<float> residual;          ///< [m] root mean square residual of the fit
    Buffer<std::uint32_t> node_of_point;  ///< kNoIndex = unassigned

    std::uint32_t add(std::uint32_t from, Vec3d at, double r = 0, bool is_fixed = false) {
        weight.push_back(0);
        residual.push_back(0);
        return InitialTree::add(from, at, r, is_fixed);
    }
};

/// Removes the nodes that `kept` does not mark; if a node remains without its parent, it becomes a child of
/// the next kept ancestor. Points of removed nodes are assigned to that ancestor if `hand_down`, otherwise to
/// no node.
void keep_nodes(CloudTree& tree, std::span<const std::uint8_t> kept, bool hand_down);

}  // namespace coppice::extract_internal
