#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/pipeline/texture/atlas_faces_internal.h"

namespace coppice::pipeline_internal {

/// Number of units along the side of an atlas: all multiples of a unit up to the side are floats.
inline constexpr std::int32_t kAtlasUnits = 1 << 24;

/// [units] Point of an atlas, at most kAtlasUnits from 0.
struct LatticePoint {
    std::int32_t x = 0;  ///< to the right
    std::int32_t y = 0;  ///< up
};

/// Returns whether a polygon is strictly convex and counter-clockwise. Exact.
bool is_convex(std::span<const LatticePoint> polygon);

/// Returns whether the interiors of two convex polygons intersect. Exact.
bool do_overlap(std::span<const LatticePoint> a, std::span<const LatticePoint> b);

/// Parts of a chart.
struct SplitChart {
    std::vector<Chart> charts;  ///< without overlapping faces
    Chart rejected;             ///< faces that are not convex, or that overlap too many others
};

/// Divides a chart so that no two faces of a part overlap. `points`: per corner of all faces. O(n) for short
/// faces and few overlaps.
SplitChart split_chart(const AtlasFaces& faces, const Chart& chart, std::span<const LatticePoint> points);

}  // namespace coppice::pipeline_internal
