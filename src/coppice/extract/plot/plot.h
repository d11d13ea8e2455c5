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

/// How trees are told apart.
struct PlotOptions {
    float least_diameter = 0.05f;  ///< [m] at breast height; thinner stems are understorey; in [0.01, 1]
    float greatest_diameter = 2;   ///< [m] of a stem; in [0.05, 20]
    float resolution =
        0;  ///< [m] edge of voxels within which all points go to one tree; 0 = from their number
    float widest_gap = 0.5f;  ///< [m] between points of one tree; in [0.01, 10]
};

template <class Self, class Visitor>
requires SameOptions<Self, PlotOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("least_diameter",
                       "Minimum diameter at breast height of a tree; thinner stems are understorey",
                       Unit::metre, 0.01, 1),
          o.least_diameter);
    visit(Field{"greatest_diameter", "Diameter above which nothing is a stem", Unit::metre, 0.05, 20},
          o.greatest_diameter);
    visit(Field{"resolution", "Edge of the voxels within which all points go to one tree; 0 chooses it",
                Unit::metre, 0, 1},
          o.resolution);
    visit(Field{"widest_gap", "Widest gap between points of one tree", Unit::metre, 0.01, 10}, o.widest_gap);
}

/// In place of the index of a tree: the point lies on the ground.
inline constexpr std::uint32_t kPointOfGround = std::numeric_limits<std::uint32_t>::max();
/// In place of the index of a tree: the point hangs on no stem.
inline constexpr std::uint32_t kPointOfNoTree = kPointOfGround - 1;

/// The trees of a plot, and whose each point is.
struct PlotSegments {
    Terrain terrain;              ///< relative to the origin of the points
    std::vector<StemForm> trees;  ///< their stems and heights, the thickest stem first
    std::vector<std::uint32_t>
        tree_of;  ///< of every point: index of its tree, kPointOfGround, kPointOfNoTree
    std::vector<std::uint32_t> ids = {};  ///< of the trees, where their points had them
};

/// Finds the ground, stems and, for every point, the tree that it belongs to.
///
/// Ground as find_terrain() has it. Stems are circles in slices from 0.3 to 3.9 m above it that lie above
/// each other (see stem_form()); those that meet above the ground belong to one tree. From all stems at once
/// shortest paths grow through the points, from one to its neighbours, so that a point goes to the tree that
/// it hangs on by the shortest way. A way counts by its length over the cube root of the diameter, as thick
/// trees reach farther (after [Tao2015]); jumps over gaps count more, and bends some metres, so that branches
/// that cross go straight on. What grows on the ground beside the stems is understorey, and goes to no tree,
/// as does what is joined to none.
///
/// O(n log n). Memory: some 60 bytes per point and 400 for each of at most 1.5 million voxels. The same bits
/// for any number of threads. Throws InvalidInput for options out of range and for fewer than 20 points, or
/// more than 2^31; Cancelled.
PlotSegments segment_plot(const PointSet& points, const PlotOptions& options = {}, const Context& ctx = {});

/// The same where trees are known: all points of an id are a tree, but those that lie on the ground. Trees
/// come in the order of their ids; what has id 0 and is no ground belongs to no tree, as do the points of
/// ids that fewer than 50 points have.
///
/// O(n log n), some 60 bytes per point. Throws InvalidInput for options out of range, ids that are not as
/// many as there are points, and for fewer than 20 points; Cancelled.
PlotSegments segment_plot_by_ids(const PointSet& points, std::span<const std::uint32_t> tree_ids,
                                 const Context& ctx = {});

/// A tree of a plot.
struct PlotTree {
    StemForm form;                          ///< position, height, diameters
    std::uint64_t points = 0;               ///< that belong to it
    std::optional<CloudExtraction> result;  ///< its skeleton; none where `warnings` say why
    TreeFigures figures;                    ///< of the skeleton; its doubts are among the warnings
    Crown crown;                            ///< of its points above crown_base
    double crown_base = 0;  ///< [m] above the ground, where the lowest large branch leaves the stem
    std::vector<std::string> warnings;  ///< what to look at
};

/// The skeletons of all trees of a plot.
struct PlotExtraction {
    PlotSegments segments;        ///< ground, stems, and whose each point is
    std::vector<PlotTree> trees;  ///< as in `segments`
};

/// Extracts each tree of a plot by extract_from_cloud(), from the foot of its stem up, with
/// `tree` for options; those for ground and the root do not count. The skeleton starts on the ground. A tree
/// that fails has no skeleton and says why in its warnings; the others come out as ever.
///
/// Time and memory are those of extract_from_cloud() for each tree; as many trees are worked on at once as
/// there are threads. The same bits for any number of threads. Throws InvalidInput for options out of range;
/// Cancelled.
PlotExtraction extract_trees(const PointSet& points, PlotSegments segments, const CloudOptions& tree = {},
                             const Context& ctx = {});

/// The trees that segment_plot() finds, extracted. Throws as these do.
PlotExtraction extract_plot(const PointSet& points, const PlotOptions& options = {},
                            const CloudOptions& tree = {}, const Context& ctx = {});

}  // namespace coppice
