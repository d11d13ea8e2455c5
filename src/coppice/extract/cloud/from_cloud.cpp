#include "coppice/extract/cloud/from_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/cloud/clean_cloud_internal.h"
#include "coppice/extract/cloud/draft_internal.h"
#include "coppice/extract/cloud/tubes_internal.h"
#include "coppice/extract/plot/segments_internal.h"
#include "coppice/extract/points/clean_internal.h"
#include "coppice/extract/points/gaps_internal.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/points/leaves_internal.h"
#include "coppice/extract/stem/stem_form_internal.h"
#include "coppice/extract/tree/draft_edit_internal.h"

namespace coppice {
namespace {

using namespace extract_internal;

constexpr std::uint32_t kSpacingRank = 4;  // the neighbour whose distance is taken for the spacing
constexpr double kGapSpacings = 10;        // widest gap that is bridged, where the user says nothing
constexpr double kGapHeight = 0.03;        // the same, of the height of the cloud
constexpr double kWidestGap = 1.5, kWidestOfHeight = 0.15;  // [m], of the height: to what is large for it
constexpr float kSteep = 0.5f;          // way aside per height, where slopes are steeper than any ground
constexpr double kDetailHeight = 0.02;  // of the height, clusters of leaves that get a twig
// The share of the time that has gone by then, on clouds of trees.
constexpr float kCleaned = 0.005f, kNeighboursFound = 0.04f, kLeavesSplit = 0.1f, kDrafted = 0.8f;
constexpr float kTubesFound = 0.46f;  // of the time that a draft takes

double height_of(std::span<const Vec3> points) {
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    return double{box.size().z};
}

GapRule gap_of(std::span<const Vec3> points, double spacing, const CloudOptions& options) {
    if (options.gap > 0) return {options.gap, options.gap};
    const double height = height_of(points), usual = std::max(kGapSpacings * spacing, kGapHeight * height);
    return {usual, std::max(usual, std::min(kWidestGap, kWidestOfHeight * height))};
}

double detail_of(std::span<const Vec3> points, const CloudOptions& options) {
    return options.detail > 0 ? options.detail : kDetailHeight * height_of(points);
}

ExtractResult result_of(const CloudDraft& draft, Vec3d origin, const Context& ctx) {
    ExtractResult out{to_skeleton(draft.tree, origin), {}, {}};
    out.confidence = rate_nodes(draft.tree, draft.samples, out.report.residual, ctx);
    for (std::uint32_t n = 0; n < draft.tree.size(); ++n) {
        NodeConfidence& c = out.confidence[n];
        c.radius_low = static_cast<float>(draft.belief.low[n]);
        c.radius_high = static_cast<float>(draft.belief.high[n]);
        c.evidence = static_cast<float>(draft.belief.measured[n]);
        out.report.samples += c.samples;
        if (draft.tree.parent[n] == kNone) continue;
        const double length = distance(draft.tree.position[n], draft.tree.position[draft.tree.parent[n]]);
        if (draft.belief.measured[n] < 0.5) out.report.presumed += length;
        if (draft.belief.limited[n]) out.report.limited += length;
    }
    out.report.trees = out.skeleton.tree_count();
    out.report.components = out.report.trees;
    out.report.pruned_twigs = draft.pruned;
    out.report.repaired_tips = draft.ends;
    return out;
}

/// Points with all that is known of them.
struct Cloud {
    Buffer<Vec3> points;
    Neighbours near;
    std::vector<std::uint8_t> outlier;
};

/// A cloud on which paths can be found.
struct PathCloud {
    Buffer<float> spacing;
    ConnectedGraph graph;
    double gap = 0;  ///< [m] greatest length of a link between neighbours
};

/// Marks what grows on the ground beside the stems.
std::uint64_t mark_understorey(Cloud& cloud, const Terrain& terrain, std::span<const StemAxis> stems,
                               double spacing, double gap, const Context& ctx) {
    constexpr double kFinest = 0.02;  // [m] voxels
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
    const GapRule gap = gap_of(cloud.points, median(out.spacing), options);
    out.gap = gap.usual;
    out.graph = connect_points(cloud.points, cloud.near, cloud.outlier, gap, ctx);
    return out;
}

/// Marks the points of leaves but for those on measured stems; empty where there are none.
std::vector<std::uint8_t> leaves_of(const Cloud& cloud, std::span<const float> spacing,
                                    std::span<const StemAxis> stems, std::optional<Vec3d> root,
                                    const CloudOptions& options, const Context& ctx) {
    if (options.leaves == LeafRule::keep) return {};
    const GapRule gap = gap_of(cloud.points, median(spacing), options);
    if (stems.size() == 1) root = stems[0].position[0];
    std::vector<std::uint8_t> leaf = find_leaves(cloud.points, cloud.near, cloud.outlier,
                                                 {options.leaves == LeafRule::drop, gap, root}, ctx);
    for (std::size_t p = 0; p < leaf.size(); ++p)
        if (leaf[p] && is_on_stem(stems, Vec3d(cloud.points[p]), double{spacing[p]})) leaf[p] = 0;
    if (std::ranges::count(leaf, 1) == 0) leaf.clear();
    return leaf;
}

/// The points of a cloud that are no leaves, and which they were.
struct Wood : Cloud {
    std::vector<std::uint32_t> place;
};

Wood wood_of(const Cloud& cloud, std::span<const std::uint8_t> leaf, const Context& ctx) {
    Wood wood;
    for (std::uint32_t p = 0; p < leaf.size(); ++p) {
        if (leaf[p]) continue;
        wood.points.push_back(cloud.points[p]);
        wood.outlier.push_back(cloud.outlier[p]);
        wood.place.push_back(p);
    }
    check_point_count(wood.points.size(), "beside leaves");
    wood.near = nearest_neighbours(wood.points, cloud.near.count, ctx);
    return wood;
}

/// The stem bases of one cloud, and a draft of the trees on them.
struct Rough {
    std::vector<std::vector<std::uint32_t>> bases;
    CloudDraft draft;
};

/// Stems as the points show them. How high the points of a tree reach is told where there is one stem.
std::vector<SeenStem> seen_stems(const Cloud& cloud, std::span<const StemAxis> stems, Vec3d origin,
                                 const Context& ctx) {
    std::vector<SeenStem> out;
    for (const StemAxis& stem : stems) out.push_back({origin + stem.position.front(), stem.breast});
    if (stems.size() != 1) return out;
    std::vector<Vec3> kept;
    for (std::size_t p = 0; p < cloud.points.size(); ++p)
        if (!cloud.outlier[p]) kept.push_back(cloud.points[p]);
    if (!kept.empty()) out[0].height = highest_of(HeightOrder(kept, ctx)) - stems[0].position.front().z;
    return out;
}

/// Which components hold points of a measured stem.
std::vector<std::uint8_t> parts_with_stems(const Cloud& cloud, const PathCloud& paths,
                                           std::span<const StemAxis> stems) {
    std::vector<std::uint8_t> out(paths.graph.components.size.size(), 0);
    for (std::uint32_t p = 0; p < cloud.points.size(); ++p)
        if (is_on_stem(stems, Vec3d(cloud.points[p]), double{paths.spacing[p]}))
            out[paths.graph.components.of[p]] = 1;
    return out;
}

/// Whether a place is above points of a tree with a measured stem, in a steep cone: no ground is there.
bool hangs(const Cloud& cloud, const Components& parts, std::span<const std::uint8_t> has_stem, Vec3 at) {
    for (std::uint32_t p = 0; p < cloud.points.size(); ++p) {
        if (cloud.outlier[p] || !has_stem[parts.of[p]]) continue;
        const Vec3 d = at - cloud.points[p];
        if (std::hypot(d.x, d.y) < kSteep * d.z) return true;
    }
    return false;
}

/// The bases of trees that stand on the ground and whose stem is not among those that were measured.
std::vector<std::vector<std::uint32_t>> other_bases(const Cloud& cloud, const PathCloud& paths,
                                                    std::span<const StemAxis> stems,
                                                    const RootOptions& options, const Context& ctx) {
    const Components& parts = paths.graph.components;
    if (!stems.empty() && options.given) return {};
    const std::vector<std::uint8_t> has_stem = parts_with_stems(cloud, paths, stems);
    const Graph near = make_graph(cloud.near, cloud.outlier, paths.graph.bridges, ctx, paths.gap);
    auto bases = find_roots(cloud.points, near, parts, options, ctx);
    std::erase_if(bases, [&](const auto& base) {
        return has_stem[parts.of[base[0]]] != 0 || hangs(cloud, parts, has_stem, cloud.points[base[0]]);
    });
    if (options.most_trees > 0) {
        const auto left = static_cast<std::size_t>(options.most_trees);
        bases.resize(std::min(bases.size(), left - std::min(left, stems.size())));
    }
    return bases;
}

/// [m] No branch is thicker than the stems that were measured, or a tenth of the cloud: hulls of crowns are.
double thickest_of(std::span<const Vec3> points, std::span<const StemAxis> stems, StemBases bases) {
    constexpr double kOfStem = 1.2, kOfCloud = 0.1;
    double most = 0;
    for (const StemAxis& stem : stems) most = std::max(most, kOfStem * stem.radius.front());
    if (bases.empty()) return most;
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    return std::max(most, kOfCloud * double{box.diagonal()});
}

Rough rough_draft(const Cloud& cloud, const PathCloud& paths, const CloudOptions& options,
                  std::span<const StemAxis> stems, std::optional<Vec3d> root, const Context& ctx) {
    const Graph& graph = paths.graph.graph;
    const double spacing = median(paths.spacing);
    Rough out{other_bases(cloud, paths, stems, {spacing, root, options.max_trees}, ctx), {}};
    if (out.bases.empty() && stems.empty())
        throw InvalidInput("extract: no part of the cloud is large enough for a tree; set root");
    const Buffer<Vec3> outward = growth_directions(cloud.points, stems, out.bases, ctx);
    CloudTree tubes =
        find_tubes(cloud.points, graph, stems, out.bases, paths.spacing,
                   {options.step, options.fit_passes, thickest_of(cloud.points, stems, out.bases)},
                   part_of(ctx, 0, kTubesFound));
    FitSamples samples{cloud.points, {}, {tubes.node_of_point.begin(), tubes.node_of_point.end()}};
    out.draft = draft_from_cloud(std::move(tubes), std::move(samples),
                                 {graph, out.bases, paths.spacing, outward, {options.step, options.twig}},
                                 part_of(ctx, kTubesFound, 1));
    return out;
}

/// The same draft among all points of the cloud.
void place_among(Rough& rough, std::span<const Vec3> points, std::span<const std::uint32_t> place) {
    for (auto& base : rough.bases)
        for (std::uint32_t& p : base) p = place[p];
    std::vector<std::uint32_t> node(points.size(), kNone);
    for (std::size_t p = 0; p < place.size(); ++p) node[place[p]] = rough.draft.samples.node[p];
    rough.draft.samples = {points, {}, std::move(node)};
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
    if (options.root) root = *options.root - set.origin;
    const Buffer<float> spacing = local_spacing(cloud.near, kSpacingRank);
    cleaning.spacing = median(spacing);
    const std::vector<StemAxis> stems =
        find_stem_axes(cloud.points, clean.terrain, {cleaning.spacing, root, options.max_trees}, ctx);
    cleaning.understorey = mark_understorey(cloud, clean.terrain, stems, cleaning.spacing,
                                            gap_of(cloud.points, cleaning.spacing, options).widest, ctx);
    // Paths take mostly one thread, so that leaves are looked for meanwhile.
    PathCloud paths;
    std::vector<std::uint8_t> leaf;
    parallel_for(ctx, 2, 1, [&](std::size_t part) {
        if (part == 0) {
            paths = make_path_cloud(cloud, spacing, options, ctx);
        } else {
            leaf = leaves_of(cloud, spacing, stems, root, options, ctx);
        }
    });
    cleaning.leaves = static_cast<std::uint64_t>(std::ranges::count(leaf, 1));
    ctx.report(kLeavesSplit);
    Rough rough;
    if (cleaning.leaves == 0) {
        rough = rough_draft(cloud, paths, options, stems, root, part_of(ctx, kLeavesSplit, kDrafted));
    } else {
        const Wood wood = wood_of(cloud, leaf, ctx);
        rough = rough_draft(wood, make_path_cloud(wood, local_spacing(wood.near, kSpacingRank), options, ctx),
                            options, stems, root, part_of(ctx, kLeavesSplit, kDrafted));
        place_among(rough, cloud.points, wood.place);
    }
    const DraftOptions wanted{.step = options.step,
                              .reach = options.twig,
                              .detail = detail_of(cloud.points, options),
                              .area_limit = options.area_limit};
    const Buffer<Vec3> outward = growth_directions(cloud.points, stems, rough.bases, ctx);
    settle_draft(rough.draft, {paths.graph.graph, rough.bases, paths.spacing, outward, wanted, leaf},
                 part_of(ctx, kDrafted, 1));
    cleaning.unreached = cloud.points.size() - cleaning.outliers - cleaning.understorey - rough.draft.reached;
    CloudExtraction out{result_of(rough.draft, set.origin, ctx), cleaning, {}, {{}, set.origin}};
    out.trees = tree_figures(out.skeleton, out.confidence, seen_stems(cloud, stems, set.origin, ctx));
    for (std::size_t p = 0; p < leaf.size(); ++p)
        if (leaf[p]) out.leaves.positions.push_back(cloud.points[p]);
    out.report.joined = static_cast<std::uint32_t>(paths.graph.bridges.size()) + paths.graph.wide;
    ctx.report(1);
    return out;
}

}  // namespace coppice
