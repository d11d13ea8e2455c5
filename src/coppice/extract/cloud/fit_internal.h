#pragma once

#include <span>

#include "coppice/extract/cloud/tree_internal.h"

namespace coppice::extract_internal {

/// Centres every node from `first` on in the branch about it and measures its radius: fits circles `passes`
/// times to the points along the axis within reach, projected along the axis, without outliers; then smooths
/// the axes within the uncertainty of the fits. A node without a good fit moves to the mean of its points and
/// its weight is 0.
void fit_axes(CloudTree& tree, std::uint32_t first, std::span<const Vec3> points, int passes,
              const Context& ctx);

}  // namespace coppice::extract_internal
