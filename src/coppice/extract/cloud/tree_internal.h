#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/vec.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// A skeleton in the making, and which points belong to which node. A radius of 0 is not known yet.
struct CloudTree : DraftTree {
    std::vector<float> weight;            ///< trust in the radius: points of the fit, 0 = none
    std::vector<float> residual;          ///< [m] root mean square of the fit
    Buffer<std::uint32_t> node_of_point;  ///< kNone = left out

    std::uint32_t add(std::uint32_t from, Vec3d at, double r = 0, bool is_fixed = false) {
        weight.push_back(0);
        residual.push_back(0);
        return DraftTree::add(from, at, r, is_fixed);
    }
};

/// Leaves out the nodes that `kept` does not mark, which must hold all their descendants; points go to the
/// nearest ancestor that stays where `hand_down`, else nowhere. Nodes between others may go too: their
/// children join their parents.
void keep_nodes(CloudTree& tree, std::span<const std::uint8_t> kept, bool hand_down);

}  // namespace coppice::extract_internal
