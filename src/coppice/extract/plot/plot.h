#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/plot/crown.h"
#include "coppice/extract/plot/terrain.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/extract/stem/tree_figures.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// Options of the segmentation of a plot.
struct PlotOptions {
    float min_diameter = 0.05f;  ///< [m] minimum diameter at breast height of a tree; in [0.01, 1]
    float max_diameter = 2;      ///< [m] maximum diameter of a stem; in [0.05, 20]
    /// [m] edge of voxels with points of one tree; 0 = computed from the number of points
    float resolution = 0;
    float widest_gap = 0.5f;  ///< [m] maximum gap between points of one tree; in [0.01, 10]
};

/// Lists the members for front ends.
void list_fields(PlotOptions& o, FieldList& list);

/// Replaces the index of a tree for a point of the ground.
inline constexpr std::uint32_t kPointOfGround = std::numeric_limits<std::uint32_t>::max();
/// Replaces the index of a tree for a point that is not connected to any stem.
inline constexpr std::uint32_t kPointOfNoTree = kPointOfGround - 1;

/// Trees of a plot, and the tree of each point.
struct PlotSegments {
    Terrain terrain;                      ///< relative to the origin of the points
    std::vector<StemForm> trees;          ///< stems and heights, thickest stem first
    std::vector<std::uint32_t> tree_of;   ///< per point: index of its tree, kPointOfGround or kPointOfNoTree
    std::vector<std::uint32_t> ids = {};  ///< ids of the trees, if their points had ids
};

/// Finds the ground, the stems and, for every point, its tree.
///
/// The ground is that of find_terrain(). Stems are circles in slices from 0.3 to 3.9 m above it that form a
/// stack (see stem_form()); stems that meet above the ground belong to one tree. Shortest paths grow from all
/// stems at once through neighbouring points, so that each point belongs to the tree with the shortest path
/// to it. The length of a path is divided by the cube root of the diameter of the stem, because thick trees
/// reach farther (after [Tao2015]); jumps over gaps have a higher cost, and bends cost some metres, so that
/// branches that cross continue straight on. Plants on the ground near the stems are understorey and belong
/// to no tree, like points that are not connected to any.
///
/// O(n log n). Memory: some 60 bytes per point and 400 for each of at most 1.5 million voxels. The result
/// does not depend on the number of threads. Throws InvalidInput for options out of range and for fewer than
/// 20 points, or more than 2^31; Cancelled.
PlotSegments segment_plot(const PointSet& points, const PlotOptions& options = {}, const Context& ctx = {});

/// Segments a plot with known trees: all points with the same id form a tree, except those on the ground.
/// Trees are sorted by id; points with id 0 that are not ground belong to no tree, like points with an id of
/// fewer than 50 points.
///
/// O(n log n), some 60 bytes per point. Throws InvalidInput for options out of range, if the number of ids
/// differs from the number of points, and for fewer than 20 points; Cancelled.
PlotSegments segment_plot_by_ids(const PointSet& points, std::span<const std::uint32_t> tree_ids,
                                 const Context& ctx = {});

/// Tree of a plot.
struct PlotTree {
    StemForm form;                          ///< position, height, diameters
    std::uint64_t points = 0;               ///< number of its points
    std::optional<CloudExtraction> result;  ///< its skeleton; empty after a failure, see `warnings`
    TreeFigures figures;                    ///< figures of the skeleton; its doubts are among the warnings
    Crown crown;                            ///< crown of its points above crown_base
    double crown_base = 0;  ///< [m] height above the ground at which the lowest large branch leaves the stem
    std::vector<std::string> warnings;  ///< properties to check
};

/// Skeletons of all trees of a plot.
struct PlotExtraction {
    PlotSegments segments;        ///< ground, stems, and the tree of each point
    std::vector<PlotTree> trees;  ///< as in `segments`
};

/// Extracts each tree of a plot by extract_from_cloud(), from the foot of its stem up, with the options
/// `tree`; those for the ground and the root are ignored. The skeleton starts on the ground. A tree that
/// fails has no skeleton and a warning with the reason; the other trees are not affected.
///
/// Time and memory are those of extract_from_cloud() for each tree; as many trees are processed at once as
/// there are threads. The result does not depend on the number of threads. Throws InvalidInput for options
/// out of range; Cancelled.
PlotExtraction extract_trees(const PointSet& points, PlotSegments segments, const CloudOptions& tree = {},
                             const Context& ctx = {});

/// Segments a plot by segment_plot() and extracts its trees by extract_trees(). Throws the same exceptions.
PlotExtraction extract_plot(const PointSet& points, const PlotOptions& options = {},
                            const CloudOptions& tree = {}, const Context& ctx = {});

}  // namespace coppice
