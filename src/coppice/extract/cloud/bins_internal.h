#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/cloud/tree_internal.h"

namespace coppice::extract_internal {

struct BinRule {
    double step;                     ///< [spacing] between nodes
    double link;                     ///< [spacing] longest that connects the points of a node
    StemBases bases;                 ///< points of each are one node; may be empty
    std::span<const float> spacing;  ///< [m] per point
};

/// Turns the points on paths into nodes, which it adds: points are binned by cost in steps, and every
/// connected component of a bin is a node [Xu2007]. Its parent is the node that most of its paths come from.
void bin_paths(CloudTree& tree, std::span<const Vec3> points, const Graph& graph, const Paths& paths,
               const BinRule& rule, const Context& ctx);

}  // namespace coppice::extract_internal
