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

/// Treatment of the ground under trees.
enum class GroundRule {
    automatic,  ///< detects the ground and removes it
    none,       ///< every point is wood
    height      ///< removes points below `ground_height`
};

template <>
struct EnumNames<GroundRule> {
    static constexpr std::array<std::string_view, 3> names{"auto", "none", "height"};
};

/// Treatment of leaves.
enum class LeafRule {
    automatic,  ///< removes leaves if the cloud has some
    keep,       ///< every point is wood
    drop        ///< removes the points most similar to leaves, even if the similarity is low
};

template <>
struct EnumNames<LeafRule> {
    static constexpr std::array<std::string_view, 3> names{"auto", "keep", "drop"};
};

/// Options of the cleaning of a cloud and of the extraction of a skeleton.
struct CloudOptions {
    GroundRule ground = GroundRule::automatic;  ///< treatment of the ground
    float ground_height = 0;                    ///< [m] world, for GroundRule::height
    float voxel = 0;  ///< [m] edge length of the voxels that keep one point each; 0 keeps all points
    int max_points = 4'000'000;  ///< maximum number of points; more are downsampled by voxels; in [100, 1e8]
    int neighbours = 12;         ///< number of neighbours of each point in the graph of paths; in [4, 64]
    float outlier_factor = 4;  ///< minimum ratio of the distance of an outlier from other points to the usual
                               ///< distance; 0 keeps all
    LeafRule leaves = LeafRule::automatic;  ///< treatment of leaves
    float detail = 0;  ///< [m] leaves farther than this from all axes get a twig to their middle; 0 =
                       ///< computed from the height of the tree
    float gap = 0;     ///< [m] maximum bridged gap; 0 = computed from the spacing and the height of the tree
    float step = 1;    ///< [spacing] distance of nodes on the thinnest twigs; in [0.25, 20]
    int fit_passes = 4;    ///< number of passes that fit circles and smooth axes; in [0, 50]
    float twig = 0.75f;    ///< [spacing] minimum height of a twig above the rest of the surface; in [0, 100]
    float area_limit = 2;  ///< maximum total cross-section of the branches at one distance from the foot,
                           ///< relative to the measured stem; 0 = no limit
    int max_trees = 0;     ///< maximum number of trees, thickest first; 0 = all; in [0, 100000]
    std::optional<Vec3d> root;  ///< [m] world: position of the only tree, if set
};

/// Lists the members for front ends.
void list_fields(CloudOptions& o, FieldList& list);

/// Counts of the points removed from a cloud.
struct CloudReport {
    std::uint64_t points = 0;       ///< number of input points
    std::uint64_t duplicates = 0;   ///< points at the position of another one
    std::uint64_t downsampled = 0;  ///< points replaced by the mean of their voxel
    std::uint64_t ground = 0;       ///< points of the ground
    std::uint64_t outliers = 0;     ///< points far from all others
    std::uint64_t understorey = 0;  ///< points of plants that grow on the ground near the stems
    std::uint64_t leaves = 0;       ///< points classified as leaves
    std::uint64_t unreached = 0;    ///< points beyond gaps too wide to bridge
    double spacing = 0;             ///< [m] median distance of the used points to their fourth neighbour
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

/// Skeleton, and the points removed from the cloud.
struct CloudExtraction : ExtractResult {
    CloudReport cleaning;            ///< counts of the removed points
    std::vector<TreeFigures> trees;  ///< diameters, volumes and doubts of each tree
    PointSet leaves;                 ///< points removed as leaves
};

/// Extracts the skeleton of trees from a laser scan.
///
/// Cleaning removes exact duplicates, downsamples by voxels on request, and removes the ground (see
/// find_terrain) and outliers. Stems are measured first, by stacked circles (see stem_form): their feet are
/// the roots, and their axes and radii are final. Trees without such a stem start at the lowest sections as
/// thick as a trunk. Neighbours are connected in a graph; components closer than `gap` are bridged, large
/// ones over up to a third of their extent. Paths from the stems cost the square of each step in spacings,
/// and more where they turn or lead back.
///
/// Then tubes are found, from thick to thin: sections of about equal cost become nodes, circles are fitted to
/// their points along the axis, so that half a cylinder is sufficient, and consistent sequences keep their
/// points. Each tube is attached by the path from its lowest point to the first existing branch. Then chains
/// are added: from the farthest point along paths that is not on a surface, back to the tree, through the
/// middle of the points about the path, however few. Then all segments are fitted to all points at once,
/// laterals start where their axis meets that of the parent branch, and branches with points explained by the
/// others are removed. Chains, fit and selection run three times. Leaves are separated
/// before if the cloud has some, and are excluded from these steps: normals about wood are in a plane, those
/// among leaves have all directions.
///
/// Finally axes are smoothed, and each radius becomes the most likely one given its points and the prior of
/// trees; radii never increase outward. Sections that appear as thick branches against both are removed, and
/// thin axes continue along paths, also through leaves, of which each cluster gets one. See
/// prior/radii_internal.h.
///
/// Sources: [Xu2007] for paths, sections and the radii of branches, [Taubin1991], [Pardalos1999].
///
/// Limits: a twig needs three points, and a height of 0.75 spacings above the rest; of twigs with fewer than
/// about five points, one in two or three is found. Stems thicker than about twenty spacings can get twigs
/// that do not exist: downsample with `voxel`. Fronds, and leaves wider than a few per cent of the height,
/// are not distinguished from wood.
///
/// The origin is that of the cloud. O(n log n), about 500 bytes per point. The result moves and turns about
/// the vertical with the points, and does not depend on their order or the number of threads. Throws
/// InvalidInput for options out of range and for fewer than 20 points, before or after cleaning; Cancelled.
CloudExtraction extract_from_cloud(const PointSet& points, const CloudOptions& options = {},
                                   const Context& ctx = {});

}  // namespace coppice
