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

/// Stems of one tree: several if it forks below breast height or is coppiced. The first is the thickest.
struct TreeStems {
    std::vector<StemTrack> stems;  ///< their z are heights above the ground
    double radius() const { return stems.front().radius; }
};

/// Groups stems that meet above the ground, each with the thickest of its tree. Thickest tree first. O(n^2).
std::vector<TreeStems> trees_of_stems(std::vector<StemTrack> stems);

inline constexpr std::uint32_t kGroundPoint = std::numeric_limits<std::uint32_t>::max();
inline constexpr std::uint32_t kNoTree = kGroundPoint - 1;

struct SegmentOptions {
    double voxel = 0.03;      ///< [m] edge of the voxels in which all points belong to one tree
    double widest_gap = 0.5;  ///< [m] maximum gap between points of one tree
};

/// Returns the tree of each point: its index, kGroundPoint or kNoTree; see segment_plot(). `height` is above
/// the ground [m]. O(n log n); about 30 bytes per point, and 400 for each non-empty voxel.
std::vector<std::uint32_t> give_points_to_trees(std::span<const Vec3> points, std::span<const float> height,
                                                const Terrain& terrain, std::span<const TreeStems> trees,
                                                const SegmentOptions& options, const Context& ctx);

}  // namespace coppice::extract_internal
