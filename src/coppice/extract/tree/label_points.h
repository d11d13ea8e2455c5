#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/context.h"
#include "coppice/extract/extract_result.h"
#include "coppice/points/painted_points.h"

namespace coppice {

/// Says of points of a scan what they are by the skeleton that was extracted from it: their distance from
/// the surface of the branch that is closest in radii, its order and evidence, and whether they are wood: as
/// near to that surface as half of its radius, or half a spacing. `which` are the indices of the points,
/// `spacing` [m] is that of the extraction (CloudReport::spacing). Columns that are missing are added, where
/// distances are NaN and all else is 0 for other points. A skeleton without segments labels nothing.
/// O(n log nodes), the same bits for any number of threads. Throws Cancelled.
void label_points(PaintedPoints& scan, std::span<const std::uint32_t> which, const ExtractResult& tree,
                  double spacing, const Context& ctx = {});

}  // namespace coppice
