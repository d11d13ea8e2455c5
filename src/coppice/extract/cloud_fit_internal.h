#pragma once

#include <span>

#include "coppice/extract/cloud_tree_internal.h"

namespace coppice::extract_internal {

/// Moves every node from `first` on to the middle of the wood about it, and measures that: `passes` times,
/// circles are fitted to the points along the axis within reach, seen in the direction of the axis, with
/// outliers left out; then axes are smoothed as far as the fits leave them free. Where points do not tell,
/// the node follows their mean and its weight is 0.
void fit_axes(CloudTree& tree, std::uint32_t first, std::span<const Vec3> points, int passes,
              const Context& ctx);

/// Straightens axes where no clean fits hold their nodes: each pass draws a node halfway to the middle of its
/// neighbours. Otherwise the scatter of a few points makes thin twigs too long.
void smooth_axes(CloudTree& tree, int passes);

/// Unit directions of the axes at the nodes, away from the root.
std::vector<Vec3d> axis_directions(const CloudTree& tree, std::span<const std::uint32_t> next);

}  // namespace coppice::extract_internal
