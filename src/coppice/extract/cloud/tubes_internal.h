#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/cloud/tree_internal.h"
#include "coppice/extract/stem/stem_axis_internal.h"

namespace coppice::extract_internal {

struct TubeOptions {
    double step = 1;          ///< [spacing] distance between nodes at the finest scale
    int passes = 4;           ///< number of passes of the fits
    double thickest = 1e300;  ///< [m] maximum radius of a tube
};

/// Finds tubes from thick to thin: at each scale the points not yet assigned to a tube are divided into nodes
/// and circles are fitted; only sequences with good fits that are thick relative to the step are kept, and
/// their points are assigned to them. Thus a thick branch is never mistaken for a bundle of twigs, nor a
/// bundle of twigs for a thick branch. Tubes are loose: each is a separate tree. Measured stems are existing
/// tubes, and the first trees of the result.
CloudTree find_tubes(std::span<const Vec3> points, const Graph& graph, std::span<const StemAxis> stems,
                     StemBases bases, std::span<const float> spacing, const TubeOptions& options,
                     const Context& ctx);

}  // namespace coppice::extract_internal
