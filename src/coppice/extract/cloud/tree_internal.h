#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/vec.h"
#include "coppice/extract/cloud/graph_internal.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// A skeleton in the making, and which points belong to which node. A radius of 0 is not known yet.
struct CloudTree : DraftTree {
    std::vector<float> weight;            ///< trust in the radius: points of the fit, 0 = none
    std::vector<float> residual;          ///< [m] root mean square of the fit
    Buffer<std::uint32_t> node_of_point;  ///< kNone = left out

    std::uint32_t add(std::uint32_t above, Vec3d at, double r = 0) {
        weight.push_back(0);
        residual.push_back(0);
        return DraftTree::add(above, at, r);
    }
};

/// For every node the child that continues its axis, that with the longest way to a tip, or kNone; `longest`
/// takes that way [m].
std::vector<std::uint32_t> axis_children(const CloudTree& tree, std::vector<double>& longest);

struct Cut {
    double step;  ///< [spacing] between nodes
    double link;  ///< [spacing] longest that holds the points of a node together
};

/// Cuts the points on paths into nodes, which it adds: by cost in steps, every piece of a step that hangs
/// together being a node. Its parent is the node that most of its paths come from.
void bin_paths(CloudTree& tree, std::span<const Vec3> points, const Graph& graph, const Paths& paths,
               std::span<const std::vector<std::uint32_t>> roots, std::span<const float> spacing, Cut cut,
               const Context& ctx);

/// Leaves out the nodes that `kept` does not mark, which must hold all their descendants; points go to the
/// nearest ancestor that stays where `hand_down`, else nowhere. Nodes between others may go too: their
/// children join their parents.
void keep_nodes(CloudTree& tree, std::span<const std::uint8_t> kept, bool hand_down);

}  // namespace coppice::extract_internal
