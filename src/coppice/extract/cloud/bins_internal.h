#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/cloud/tree_internal.h"

namespace coppice::extract_internal {

struct BinRule {
    double step;                     ///< [spacing] distance between nodes
    double link;                     ///< [spacing] maximum length of a link between points of a node
    StemBases bases;                 ///< points of each become one node; may be empty
    std::span<const float> spacing;  ///< [m] per point
};

/// Converts the points on paths to nodes and adds them: points are binned by cost in steps, and every
/// connected component of a bin is a node [Xu2007]. Its parent is the node from which most of its paths
/// arrive.
void bin_paths(CloudTree& tree, std::span<const Vec3> points, const Graph& graph, const Paths& paths,
               const BinRule& rule, const Context& ctx);

}  // namespace coppice::extract_internal
