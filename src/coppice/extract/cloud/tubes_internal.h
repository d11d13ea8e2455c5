#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/cloud/tree_internal.h"
#include "coppice/extract/stem/stem_axis_internal.h"

namespace coppice::extract_internal {

struct TubeOptions {
    double step = 1;          ///< [spacing] between nodes at the finest scale
    int passes = 4;           ///< of the fits
    double thickest = 1e300;  ///< [m] greatest radius of a tube
};

/// Finds what is clearly a tube, from thick to thin: at each scale the points that no tube explains yet are
/// cut into nodes, circles are fitted, and of what is found only clean runs thick against the step are kept;
/// the points on them are theirs. So a thick branch is never taken for a bundle of twigs, nor a bundle of
/// twigs for a thick branch. Tubes are loose: each is a tree of its own.
/// Stems that were measured are tubes already, and the first trees of the result.
CloudTree find_tubes(std::span<const Vec3> points, const Graph& graph, std::span<const StemAxis> stems,
                     StemBases bases, std::span<const float> spacing, const TubeOptions& options,
                     const Context& ctx);

}  // namespace coppice::extract_internal
