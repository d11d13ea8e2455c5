#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/pipeline/texture/atlas_overlap_internal.h"

namespace coppice::pipeline_internal {

/// Size of a rectangle that is not wider than high.
struct Upright {
    double width = 0;   ///< in the unit of the caller
    double height = 0;  ///< at least the width
};

/// Places rectangles in an atlas in rows, sorted by height, at a distance of `margin` units from each other
/// and from the sides. Returns their lower left corners in units, or nothing if they do not fit. Sizes are
/// whole numbers of units. O(n log n).
std::optional<std::vector<LatticePoint>> pack_rectangles(std::span<const Upright> rectangles,
                                                         std::int32_t margin);

/// Returns the approximate maximum scale, in units per metre, at which rectangles in metres fit; 0 if they do
/// not fit at any scale. O(n log n).
double find_scale(std::span<const Upright> rectangles, std::int32_t margin);

}  // namespace coppice::pipeline_internal
