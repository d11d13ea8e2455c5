#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/cloud_tree_internal.h"

namespace coppice::extract_internal {

struct ScaleOptions {
    double step = 1;      ///< [spacing] of the finest scale
    int passes = 4;       ///< of the fits
    double reach = 0.75;  ///< [spacing] shortest twig beyond where it parts
};

/// Finds the tree from thick to thin: at each scale the points that no branch explains yet are cut into
/// nodes, circles are fitted, and of what is found only clean tubes thick against the step are kept; the
/// points on them are theirs. The last scale keeps everything. So a thick branch is never taken for a bundle
/// of twigs, nor a bundle of twigs for a thick branch.
CloudTree grow_tree(std::span<const Vec3> points, const Graph& graph,
                    std::span<const std::vector<std::uint32_t>> roots, std::span<const float> spacing,
                    const ScaleOptions& options, std::uint32_t& pruned, const Context& ctx);

}  // namespace coppice::extract_internal
