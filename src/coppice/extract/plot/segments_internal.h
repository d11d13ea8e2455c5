#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/plot/terrain.h"
#include "coppice/extract/stem/stem_search_internal.h"

namespace coppice::extract_internal {

/// The stems of one tree: forked below breast height, or a stool, it has several. The first is the thickest.
struct TreeStems {
    std::vector<StemTrack> stems;  ///< their z are heights above the ground
    double radius() const { return stems.front().radius; }
};

/// Puts stems together that meet above the ground, each with the thickest of its tree. Thickest tree first.
/// O(n^2).
std::vector<TreeStems> trees_of_stems(std::vector<StemTrack> stems);

inline constexpr std::uint32_t kGroundPoint = std::numeric_limits<std::uint32_t>::max();
inline constexpr std::uint32_t kNoTree = kGroundPoint - 1;

struct SegmentOptions {
    double voxel = 0.03;      ///< [m] within which all points are given to one tree
    double widest_gap = 0.5;  ///< [m] between points of one tree
};

/// Which tree each point belongs to: its index, kGroundPoint or kNoTree; see segment_plot(). `height` is
/// above the ground [m]. O(n log n); about 30 bytes per point, and 400 for each voxel with points.
std::vector<std::uint32_t> give_points_to_trees(std::span<const Vec3> points, std::span<const float> height,
                                                const Terrain& terrain, std::span<const TreeStems> trees,
                                                const SegmentOptions& options, const Context& ctx);

}  // namespace coppice::extract_internal
