#include "coppice/extract/cloud/from_cloud.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/base/median.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/cloud/clean_cloud_internal.h"
#include "coppice/extract/cloud/initial_tree_internal.h"
#include "coppice/extract/cloud/tubes_internal.h"
#include "coppice/extract/plot/segments_internal.h"
#include "coppice/extract/points/clean_internal.h"
#include "coppice/extract/points/gaps_internal.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/points/leaves_internal.h"
#include "coppice/extract/stem/stem_form_internal.h"
#include "coppice/extract/tree/tree_edit_internal.h"

namespace coppice {
namespace {

using namespace extract_internal;

constexpr std::uint32_t kSpacingRank = 4;  // rank of the neighbour that defines the spacing
constexpr double kGapSpacings = 10;        // [spacing] maximum gap by default
constexpr double kGapHeight = 0.03;        // [height of the cloud] maximum gap by default
constexpr double kWidestGap = 1.5;
constexpr double kWidestOfHeight = 0.15;  // [m] and [height]: maximum gap between large components
constexpr float kSteep = 0.5f;            // horizontal distance per height; steeper than any ground
constexpr double kDetailHeight = 0.02;    // [height] size of clusters of leaves that get a twig by default
// Progress at the end of each stage, on clouds of trees.
constexpr float kCleaned = 0.005f, kNeighboursFound = 0.04f, kLeavesSplit = 0.1f, kTreeBuilt = 0.8f;
constexpr float kTubesFound = 0.46f;  // share of the time of the initial tree

double compute_height(std::span<const Vec3> points) {
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    return double{box.size().z};
}

GapRule compute_gap(std::span<const Vec3> points, double spacing, const CloudOptions& options) {
    if (options.gap > 0) return {options.gap, options.gap};
    const double height = compute_height(points),
                 usual = std::max(kGapSpacings * spacing, kGapHeight * height);
    return {usual, std::max(usual, std::min(kWidestGap, kWidestOfHeight * height))};
}

double choose_detail(std::span<const Vec3> points, const CloudOptions& options) {
    return options.detail > 0 ? options.detail : kDetailHeight * compute_height(points);
}

ExtractResult make_result(const FittedTree& initial, const Context& ctx) {
    ExtractResult out{to_skeleton(initial.tree, {}), {}, {}};
    out.confidence = rate_nodes(initial.tree, initial.samples, out.report.residual, ctx);
    for (std::uint32_t n = 0; n < initial.tree.size(); ++n) {
        NodeConfidence& c = out.confidence[n];
        c.radius_low = static_cast<float>(initial.estimate.low[n]);
        c.radius_high = static_cast<float>(initial.estimate.high[n]);
        c.evidence = static_cast<float>(initial.estimate.measured[n]);
        out.report.samples += c.samples;
        if (initial.tree.parent[n] == kNoIndex) continue;
        const double length =
            distance(initial.tree.position[n], initial.tree.position[initial.tree.parent[n]]);
        if (initial.estimate.measured[n] < 0.5) out.report.inferred += length;
        if (initial.estimate.limited[n]) out.report.limited += length;
    }
    out.report.trees = out.skeleton.tree_count();
    out.report.components = out.report.trees;
    out.report.pruned_twigs = initial.pruned;
    out.report.repaired_tips = initial.ends;
    return out;
}

/// Points and their properties.
struct Cloud {
    Buffer<Vec3> points;
    Neighbours near;
    std::vector<std::uint8_t> outlier;
};

/// Graph of a cloud for paths.
struct PathCloud {
    Buffer<float> spacing;
    ConnectedGraph graph;
    double gap = 0;  ///< [m] maximum length of a link between neighbours
};

/// Returns the measured stems. The noise of the points is estimated from the spacing in `search` and, if no
/// stem is found, from the median distance to the closest point, which is less where points are few.
std::vector<StemAxis> find_stems_of_cloud(const Cloud& cloud, const Terrain& terrain, StemAxisSearch search,
                                          const Context& ctx) {
    std::vector<StemAxis> stems = find_stem_axes(cloud.points, terrain, search, ctx);
    if (!stems.empty()) return stems;
    search.spacing = median(local_spacing(cloud.near, 1));
    return find_stem_axes(cloud.points, terrain, search, ctx);
}

/// Marks plants that grow on the ground near the stems; returns the number of points.
std::uint64_t mark_understorey(Cloud& cloud, const Terrain& terrain, std::span<const StemAxis> stems,
                               double spacing, double gap, const Context& ctx) {
    constexpr double kFinest = 0.02;  // [m] minimum edge of voxels
    if (!terrain.is_ground || stems.empty()) return 0;
    Buffer<float> height(cloud.points.size());
    for (std::size_t i = 0; i < height.size(); ++i) {
        const Vec3 p = cloud.points[i];
        height[i] = static_cast<float>(double{p.z} - terrain.height(p.x, p.y));
    }
    std::vector<TreeStems> trees;
    for (const StemAxis& stem : stems) {
        const Vec3d foot = stem.position.front();
        trees.push_back({{stem.track}});
        trees.back().stems.front().raise(-terrain.height(foot.x, foot.y));
    }
    const auto tree_of = give_points_to_trees(cloud.points, height, terrain, trees,
                                              {std::max(2 * spacing, kFinest), gap}, ctx);
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < tree_of.size(); ++i) {
        if (tree_of[i] != kNoTree || cloud.outlier[i]) continue;
        cloud.outlier[i] = 1;
        ++count;
    }
    return count;
}

PathCloud make_path_cloud(const Cloud& cloud, Buffer<float> spacing, const CloudOptions& options,
                          const Context& ctx) {
    PathCloud out{std::move(spacing), {}};
    const GapRule gap = compute_gap(cloud.points, median(out.spacing), options);
    out.gap = gap.usual;
    out.graph = connect_points(cloud.points, cloud.near, cloud.outlier, gap, ctx);
    return out;
}

/// Marks the points of leaves except those on measured stems; empty without leaves.
std::vector<std::uint8_t> mark_leaves(const Cloud& cloud, std::span<const float> spacing,
                                      std::span<const StemAxis> stems, std::optional<Vec3d> root,
                                      const CloudOptions& options, const Context& ctx) {
    if (options.leaves == LeafRule::keep) return {};
    const GapRule gap = compute_gap(cloud.points, median(spacing), options);
    if (stems.size() == 1) root = stems[0].position[0];
    std::vector<std::uint8_t> leaf = find_leaves(cloud.points, cloud.near, cloud.outlier,
                                                 {options.leaves == LeafRule::drop, gap, root}, ctx);
    for (std::size_t p = 0; p < leaf.size(); ++p)
        if (leaf[p] && is_on_stem(stems, Vec3d(cloud.points[p]), double{spacing[p]})) leaf[p] = 0;
    if (std::ranges::count(leaf, 1) == 0) leaf.clear();
    return leaf;
}

/// Points of a cloud that are not leaves, and their original indices.
struct Wood : Cloud {
    std::vector<std::uint32_t> place;
};

Wood select_wood(const Cloud& cloud, std::span<const std::uint8_t> leaf, const Context& ctx) {
    Wood wood;
    for (std::uint32_t p = 0; p < leaf.size(); ++p) {
        if (leaf[p]) continue;
        wood.points.push_back(cloud.points[p]);
        wood.outlier.push_back(cloud.outlier[p]);
        wood.place.push_back(p);
    }
    check_point_count(wood.points.size(), "after the removal of leaves");
    wood.near = nearest_neighbours(wood.points, cloud.near.count, ctx);
    return wood;
}

/// Stem bases of one cloud, and an initial tree.
struct Rough {
    std::vector<std::vector<std::uint32_t>> bases;
    FittedTree initial;
};

/// Returns the stems as measured in the points. The height of the points of a tree is known only if there is
/// one stem.
std::vector<SeenStem> seen_stems(const Cloud& cloud, std::span<const StemAxis> stems, const Context& ctx) {
    std::vector<SeenStem> out;
    for (const StemAxis& stem : stems) out.push_back({stem.position.front(), stem.breast});
    if (stems.size() != 1) return out;
    std::vector<Vec3> kept;
    for (std::size_t p = 0; p < cloud.points.size(); ++p)
        if (!cloud.outlier[p]) kept.push_back(cloud.points[p]);
    if (!kept.empty())
        out[0].height = compute_max_height(HeightOrder(kept, ctx)) - stems[0].position.front().z;
    return out;
}

/// Marks the components with points of a measured stem.
std::vector<std::uint8_t> parts_with_stems(const Cloud& cloud, const PathCloud& paths,
                                           std::span<const StemAxis> stems) {
    std::vector<std::uint8_t> out(paths.graph.components.size.size(), 0);
    for (std::uint32_t p = 0; p < cloud.points.size(); ++p)
        if (is_on_stem(stems, Vec3d(cloud.points[p]), double{paths.spacing[p]}))
            out[paths.graph.components.of[p]] = 1;
    return out;
}

/// Returns whether a position is in a steep cone above points of a tree with a measured stem, so that no
/// ground can be there.
bool hangs(const Cloud& cloud, const Components& parts, std::span<const std::uint8_t> has_stem, Vec3 at) {
    for (std::uint32_t p = 0; p < cloud.points.size(); ++p) {
        if (cloud.outlier[p] || !has_stem[parts.of[p]]) continue;
        const Vec3 d = at - cloud.points[p];
        if (std::hypot(d.x, d.y) < kSteep * d.z) return true;
    }
    return false;
}

/// Returns the bases of rooted trees without a measured stem.
std::vector<std::vector<std::uint32_t>> other_bases(const Cloud& cloud, const PathCloud& paths,
                                                    std::span<const StemAxis> stems,
                                                    const RootOptions& options, const Context& ctx) {
    const Components& parts = paths.graph.components;
    if (!stems.empty() && options.given) return {};
    const std::vector<std::uint8_t> has_stem = parts_with_stems(cloud, paths, stems);
    // Only large components have a base, and none of those with a measured stem needs one.
    const std::vector<std::uint8_t> large = mark_large_parts(parts);
    if (!options.given && std::ranges::equal(large, has_stem, std::less_equal{})) return {};
    const Graph near = make_graph(cloud.near, cloud.outlier, paths.graph.bridges, ctx, paths.gap);
    auto bases = find_roots(cloud.points, near, parts, options, ctx);
    std::erase_if(bases, [&](const auto& base) {
        return has_stem[parts.of[base[0]]] != 0 || hangs(cloud, parts, has_stem, cloud.points[base[0]]);
    });
    if (options.max_trees > 0) {
        const auto left = static_cast<std::size_t>(options.max_trees);
        bases.resize(std::min(bases.size(), left - std::min(left, stems.size())));
    }
    return bases;
}

/// Returns the maximum radius [m] of a branch, from the measured stems or a tenth of the extent of the cloud;
/// hulls of crowns exceed it.
double estimate_max_radius(std::span<const Vec3> points, std::span<const StemAxis> stems, StemBases bases) {
    constexpr double kOfStem = 1.2, kOfCloud = 0.1;
    double most = 0;
    for (const StemAxis& stem : stems) most = std::max(most, kOfStem * stem.radius.front());
    if (bases.empty()) return most;
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    return std::max(most, kOfCloud * double{box.diagonal()});
}

Rough build_rough_tree(const Cloud& cloud, const PathCloud& paths, const CloudOptions& options,
                       std::span<const StemAxis> stems, std::optional<Vec3d> root, const Context& ctx) {
    const Graph& graph = paths.graph.graph;
    const double spacing = median(paths.spacing);
    Rough out{other_bases(cloud, paths, stems, {spacing, root, options.max_trees}, ctx), {}};
    if (out.bases.empty() && stems.empty())
        throw InvalidInput("extract: no component of the cloud is large enough for a tree; set root");
    const Buffer<Vec3> outward = growth_directions(cloud.points, stems, out.bases, ctx);
    CloudTree tubes =
        find_tubes(cloud.points, graph, stems, out.bases, paths.spacing,
                   {options.step, options.fit_passes, estimate_max_radius(cloud.points, stems, out.bases)},
                   narrow_progress(ctx, 0, kTubesFound));
    FitSamples samples{cloud.points, {}, {tubes.node_of_point.begin(), tubes.node_of_point.end()}};
    out.initial = build_initial_tree(std::move(tubes), std::move(samples),
                                     {graph, out.bases, paths.spacing, outward, {options.step, options.twig}},
                                     narrow_progress(ctx, kTubesFound, 1));
    return out;
}

/// Maps the initial tree to all points of the cloud.
void place_among(Rough& rough, std::span<const Vec3> points, std::span<const std::uint32_t> place) {
    for (auto& base : rough.bases)
        for (std::uint32_t& p : base) p = place[p];
    std::vector<std::uint32_t> node(points.size(), kNoIndex);
    for (std::size_t p = 0; p < place.size(); ++p) node[place[p]] = rough.initial.samples.node[p];
    rough.initial.samples = {points, {}, std::move(node)};
}

/// Returns the skeleton moved from the frame of a cloud to the cloud.
Skeleton leave_frame(const Skeleton& skeleton, const CloudFrame& frame, Vec3d origin) {
    std::vector<Vec3> position;
    for (const Vec3 p : skeleton.positions()) position.emplace_back(frame.to_cloud(Vec3d(p)));
    return {{skeleton.parents().begin(), skeleton.parents().end()},
            std::move(position),
            {skeleton.radii().begin(), skeleton.radii().end()},
            origin};
}

}  // namespace

CloudExtraction extract_from_cloud(const PointSet& set, const CloudOptions& options, const Context& ctx) {
    check_fields(options, "extract");
    CloudReport cleaning;
    CleanCloud clean = clean_cloud(set, options, cleaning, ctx);
    Cloud cloud{std::move(clean.points), {}, {}};
    ctx.report(kCleaned);
    cloud.near = nearest_neighbours(cloud.points, static_cast<std::uint32_t>(options.neighbours), ctx);
    ctx.report(kNeighboursFound);
    cloud.outlier.assign(cloud.points.size(), 0);
    if (options.outlier_factor > 0) cloud.outlier = find_outliers(cloud.near, options.outlier_factor, ctx);
    cleaning.outliers = static_cast<std::uint64_t>(std::ranges::count(cloud.outlier, 1));

    std::optional<Vec3d> root;
    if (options.root) root = clean.frame.to_frame(*options.root - set.origin);
    const Buffer<float> spacing = local_spacing(cloud.near, kSpacingRank);
    cleaning.spacing = median(spacing);
    const std::vector<StemAxis> stems =
        find_stems_of_cloud(cloud, clean.terrain, {cleaning.spacing, root, options.max_trees}, ctx);
    cleaning.understorey = mark_understorey(cloud, clean.terrain, stems, cleaning.spacing,
                                            compute_gap(cloud.points, cleaning.spacing, options).widest, ctx);
    // Paths use mostly one thread, so that leaves are found in parallel.
    PathCloud paths;
    std::vector<std::uint8_t> leaf;
    parallel_for(ctx, 2, 1, [&](std::size_t part) {
        if (part == 0) {
            paths = make_path_cloud(cloud, spacing, options, ctx);
        } else {
            leaf = mark_leaves(cloud, spacing, stems, root, options, ctx);
        }
    });
    cleaning.leaves = static_cast<std::uint64_t>(std::ranges::count(leaf, 1));
    ctx.report(kLeavesSplit);
    Rough rough;
    if (cleaning.leaves == 0) {
        rough = build_rough_tree(cloud, paths, options, stems, root,
                                 narrow_progress(ctx, kLeavesSplit, kTreeBuilt));
    } else {
        const Wood wood = select_wood(cloud, leaf, ctx);
        rough = build_rough_tree(wood,
                                 make_path_cloud(wood, local_spacing(wood.near, kSpacingRank), options, ctx),
                                 options, stems, root, narrow_progress(ctx, kLeavesSplit, kTreeBuilt));
        place_among(rough, cloud.points, wood.place);
    }
    const InitialTreeOptions wanted{.step = options.step,
                                    .reach = options.twig,
                                    .detail = choose_detail(cloud.points, options),
                                    .area_limit = options.area_limit};
    const Buffer<Vec3> outward = growth_directions(cloud.points, stems, rough.bases, ctx);
    const Buffer<float> next = local_step(cloud.near, kSpacingRank);
    finalize_tree(rough.initial, {paths.graph.graph, rough.bases, paths.spacing, outward, wanted, leaf, next},
                  narrow_progress(ctx, kTreeBuilt, 1));
    cleaning.unreached =
        cloud.points.size() - cleaning.outliers - cleaning.understorey - rough.initial.reached;
    CloudExtraction out{make_result(rough.initial, ctx), cleaning, {}, {{}, set.origin}};
    out.trees = tree_figures(out.skeleton, out.confidence, seen_stems(cloud, stems, ctx));
    out.skeleton = leave_frame(out.skeleton, clean.frame, set.origin);
    std::vector<Vec3> leaves;
    for (std::size_t p = 0; p < leaf.size(); ++p)
        if (leaf[p]) leaves.push_back(cloud.points[p]);
    if (!leaves.empty()) out.leaves.positions = leave_frame(clean.frame, leaves, set.positions, ctx);
    out.report.joined = static_cast<std::uint32_t>(paths.graph.bridges.size()) + paths.graph.wide;
    ctx.report(1);
    return out;
}

void list_fields(CloudOptions& o, FieldList& list) {
    list.add(
        common_field("ground",
                     "Points to remove as ground: those that look like it, none, or all below a height."),
        o.ground);
    list.add(Field{"ground_height", "Height below which points are ground.", Unit::metre, -1e6, 1e6},
             o.ground_height);
    list.add(common_field("voxel", "Edge length of the voxels that keep one point each; 0 keeps all points.",
                          Unit::metre, 0, 1e6),
             o.voxel);
    list.add(
        Field{"max_points", "Maximum number of points; larger clouds are downsampled.", Unit::none, 100, 1e8},
        o.max_points);
    list.add(
        Field{"neighbours", "Number of neighbours of each point in the graph of paths.", Unit::none, 4, 64},
        o.neighbours);
    list.add(Field{"outlier_factor",
                   "Minimum ratio of the distance of an outlier from its neighbours to the usual distance; 0 "
                   "keeps all points.",
                   Unit::none, 0, 1e6},
             o.outlier_factor);
    list.add(common_field(
                 "leaves",
                 "Treatment of leaves: removed where the cloud has some, kept as wood, or always removed."),
             o.leaves);
    list.add(Field{"leaf_cluster_distance",
                   "Minimum distance from all axes of a cluster of leaves that gets a twig to its middle; 0 "
                   "computes it from the height of the tree.",
                   Unit::metre, 0, 1e6},
             o.detail);
    list.add(Field{"gap",
                   "Maximum gap that is bridged; 0 computes it from the spacing and the height of the tree.",
                   Unit::metre, 0, 1e6},
             o.gap);
    list.add(Field{"twig_node_spacing", "Distance of nodes on the thinnest twigs, in spacings of the points.",
                   Unit::none, 0.25, 20},
             o.step);
    list.add(Field{"fit_passes", "Number of passes that fit circles and smooth axes.", Unit::none, 0, 50},
             o.fit_passes);
    list.add(Field{"min_twig_height",
                   "Minimum height of a twig above the rest of the surface, in spacings of the points.",
                   Unit::none, 0, 100},
             o.twig);
    list.add(
        Field{"area_limit",
              "Maximum total cross-section of the branches at one distance from the foot, relative to that "
              "of the measured stem; 0 sets no limit.",
              Unit::none, 0, 1000},
        o.area_limit);
    list.add(
        common_field("max_trees", "Maximum number of trees to keep; 0 keeps all.", Unit::none, 0, 100000),
        o.max_trees);
    list.add(Field{"root", "Point closest to the root of the tree; by default the root is the lowest end.",
                   Unit::metre},
             o.root);
}

}  // namespace coppice
