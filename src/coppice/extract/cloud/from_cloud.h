#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/base/vec.h"
#include "coppice/extract/extract_result.h"
#include "coppice/extract/stem/tree_figures.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// What becomes of the ground under trees.
enum class GroundRule {
    automatic,  ///< looks for ground, and leaves it out where there is some
    none,       ///< every point is wood
    height      ///< points below `ground_height` are left out
};

template <>
struct EnumNames<GroundRule> {
    static constexpr std::array<std::string_view, 3> names{"auto", "none", "height"};
};

/// What becomes of leaves.
enum class LeafRule {
    automatic,  ///< leaves are left out where the cloud shows some
    keep,       ///< every point is wood
    drop        ///< what looks most like leaves is left out, even where nothing much does
};

template <>
struct EnumNames<LeafRule> {
    static constexpr std::array<std::string_view, 3> names{"auto", "keep", "drop"};
};

/// How a cloud is cleaned, and how a skeleton is read off it.
struct CloudOptions {
    GroundRule ground = GroundRule::automatic;  ///< whether ground is looked for
    float ground_height = 0;                    ///< [m] world, for GroundRule::height
    float voxel = 0;                            ///< [m] edge of voxels of which one point is kept; 0 = none
    int max_points = 4'000'000;  ///< more are downsampled, with voxels as large as it takes; in [100, 1e8]
    int neighbours = 12;         ///< of every point, that paths may go to; in [4, 64]
    float outlier_factor =
        4;  ///< points this many times farther from others than is usual about go; 0 = none
    LeafRule leaves = LeafRule::automatic;  ///< whether leaves are looked for
    float detail =
        0;  ///< [m] leaves farther from all axes get a twig to their middle; 0 = from the height of the tree
    float gap = 0;       ///< [m] widest gap that is bridged; 0 = from the spacing and height of the tree
    float step = 1;      ///< [spacing] between nodes on the thinnest twigs; in [0.25, 20]
    int fit_passes = 4;  ///< times that circles are fitted and axes smoothed; in [0, 50]
    float twig = 0.75f;  ///< [spacing] what rises less above the rest of the surface is no twig; in [0, 100]
    float area_limit =
        2;              ///< what branches as far from the foot have together, over the measured stem; 0 = any
    int max_trees = 0;  ///< the thickest so many are kept; 0 = all; in [0, 100000]
    std::optional<Vec3d> root;  ///< [m] world: there is one tree, and it stands at the point nearest to this
};

template <class Self, class Visitor>
requires SameOptions<Self, CloudOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("ground",
                       "Points to remove as ground: those that look like it, none, or all below a height"),
          o.ground);
    visit(Field{"ground_height", "Height below which points are ground", Unit::metre, -1e6, 1e6},
          o.ground_height);
    visit(common_field("voxel", "Edge length of the voxels that keep one point each; 0 keeps all points",
                       Unit::metre, 0, 1e6),
          o.voxel);
    visit(Field{"max_points", "Number of points above which they are downsampled", Unit::none, 100, 1e8},
          o.max_points);
    visit(Field{"neighbours", "Number of neighbours that paths may go to", Unit::none, 4, 64}, o.neighbours);
    visit(Field{"outlier_factor",
                "Points so many times farther off than their neighbours are outliers, left out; 0 = none",
                Unit::none, 0, 1e6},
          o.outlier_factor);
    visit(common_field(
              "leaves",
              "Treatment of leaves: removed where the cloud has some, kept as wood, or always removed"),
          o.leaves);
    visit(
        Field{"detail",
              "Clusters of leaves farther than this from all axes get one twig to their middle; 0 chooses it",
              Unit::metre, 0, 1e6},
        o.detail);
    visit(Field{"gap", "Widest gap that is bridged; 0 chooses it", Unit::metre, 0, 1e6}, o.gap);
    visit(Field{"step", "Distance of nodes on the thinnest twigs, in spacings of the points", Unit::none,
                0.25, 20},
          o.step);
    visit(Field{"fit_passes", "Times that circles are fitted", Unit::none, 0, 50}, o.fit_passes);
    visit(Field{"twig", "Height above the rest of the surface that makes a twig, in spacings of the points",
                Unit::none, 0, 100},
          o.twig);
    visit(Field{"area_limit",
                "Maximum cross-section of all branches as far from the foot, over that of the measured stem; "
                "0 sets no limit",
                Unit::none, 0, 1000},
          o.area_limit);
    visit(common_field("max_trees", "Maximum number of trees to keep; 0 keeps all", Unit::none, 0, 100000),
          o.max_trees);
    visit(Field{"root", "the root is where the tree is nearest to this place; else it is the lowest end",
                Unit::metre},
          o.root);
}

/// What was left out of a cloud, counted in points.
struct CloudReport {
    std::uint64_t points = 0;       ///< that were given
    std::uint64_t duplicates = 0;   ///< at the place of another one
    std::uint64_t downsampled = 0;  ///< the mean of their voxel stands for them
    std::uint64_t ground = 0;       ///< of the ground
    std::uint64_t outliers = 0;     ///< far from all others
    std::uint64_t understorey = 0;  ///< that grow on the ground beside the stems
    std::uint64_t leaves = 0;       ///< taken for leaves
    std::uint64_t unreached = 0;    ///< beyond gaps too wide to bridge
    double spacing = 0;             ///< [m] median distance of the points used to their fourth neighbour
};

/// Calls visit(name, number) for every member, in order.
template <class Visitor>
void visit_figures(const CloudReport& r, Visitor&& visit) {
    visit("points", r.points);
    visit("duplicates", r.duplicates);
    visit("downsampled", r.downsampled);
    visit("ground", r.ground);
    visit("outliers", r.outliers);
    visit("understorey", r.understorey);
    visit("leaves", r.leaves);
    visit("unreached", r.unreached);
    visit("spacing", r.spacing);
}

/// A skeleton, and what was left out of the cloud.
struct CloudExtraction : ExtractResult {
    CloudReport cleaning;            ///< points by what became of them
    std::vector<TreeFigures> trees;  ///< diameters, volumes and doubts of each tree
    PointSet leaves;                 ///< the points that were left out as leaves
};

/// The skeleton of what a scanner saw of trees.
///
/// Cleaning: exact duplicates go, voxels downsample where asked for, ground goes (see find_terrain), then
/// outliers. Stems are measured first, by circles that stack (see stem_form): their feet are the roots, and
/// nothing changes their axes and radii. Trees without such a stem stand at the lowest places as thick as a
/// trunk. Neighbours are joined in a graph, components nearer than `gap` are bridged, large ones over up to a
/// third of their extent; paths from the stems cost the square of each step in spacings, more where they turn
/// or lead back.
///
/// Tubes next, from thick to thin: pieces of about equal cost become nodes, circles are fitted to their
/// points along the axis, so half a cylinder is enough, and clean runs keep their points. Each is
/// attached by the path from its lowest point to what that meets. Then chains: from the point farthest along
/// paths that lies on no surface yet, back to the tree, through the middle of the points about the path,
/// however few. Then all segments are fitted to all points at once (see capsule_fit.h), laterals start where
/// their axis meets the one they leave, and branches whose points the others explain go. Chains, fit and
/// selection run three times. Leaves are told before where the cloud shows some, and stay out of all that:
/// normals about wood lie in a plane, those amid leaves point everywhere.
///
/// Last, axes are smoothed, and radii become the most likely ones by what points say and by what trees are
/// like; they never grow outward. What looked like thick wood against both is cut out, and thin axes lead on
/// along paths, through leaves too, of which each cluster gets one. See prior/radii_internal.h.
///
/// Sources: [Xu2007] for paths, pieces and how thick branches are, [Taubin1991], [Pardalos1999].
///
/// Limits: a twig needs three points, and to rise 0.75 spacings above the rest: where there are fewer than
/// about five points on it, one in two or three is found. Stems thicker than about twenty spacings can grow
/// twigs that are not there: downsample with `voxel`. Fronds, and leaves wider than a few per cent of the
/// height, are not told from wood.
///
/// The origin is that of the cloud. O(n log n), about 500 bytes per point, the same bits for any number of
/// threads. Throws InvalidInput for options out of range and for fewer than 20 points, before or after
/// cleaning; Cancelled.
CloudExtraction extract_from_cloud(const PointSet& points, const CloudOptions& options = {},
                                   const Context& ctx = {});

}  // namespace coppice
