#pragma once

#include <span>

#include "coppice/extract/cloud/tree_internal.h"

namespace coppice::extract_internal {

/// Moves every node from `first` on to the middle of the wood about it, and measures that: `passes` times,
/// circles are fitted to the points along the axis within reach, seen in the direction of the axis, with
/// outliers left out; then axes are smoothed as far as the fits leave them free. Where points do not tell,
/// the node follows their mean and its weight is 0.
void fit_axes(CloudTree& tree, std::uint32_t first, std::span<const Vec3> points, int passes,
              const Context& ctx);

}  // namespace coppice::extract_internal
