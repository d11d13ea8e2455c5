#include "coppice/extract/cloud/from_cloud.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/median.h"
#include "coppice/base/progress.h"
#include "coppice/extract/cloud/clean_cloud_internal.h"
#include "coppice/extract/cloud/draft_internal.h"
#include "coppice/extract/cloud/tubes_internal.h"
#include "coppice/extract/points/clean_internal.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/points/leaves_internal.h"
#include "coppice/extract/tree/draft_edit_internal.h"

namespace coppice {
namespace {

using namespace extract_internal;

constexpr std::uint32_t kSpacingRank = 4;  // the neighbour whose distance is taken for the spacing
constexpr double kGapSpacings = 10;        // widest gap that is bridged, where the user says nothing
constexpr double kGapHeight = 0.03;        // the same, of the height of the cloud
constexpr double kDetailHeight = 0.02;     // of the height, clusters of leaves that get a twig
// The share of the time that has gone by then, on clouds of trees.
constexpr float kCleaned = 0.005f, kNeighboursFound = 0.04f, kLeavesSplit = 0.1f, kDrafted = 0.8f;
constexpr float kTubesFound = 0.46f;  // of the time that a draft takes

double height_of(std::span<const Vec3> points) {
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    return double{box.size().z};
}

double gap_of(std::span<const Vec3> points, double spacing, const CloudOptions& options) {
    if (options.gap > 0) return options.gap;
    return std::max(kGapSpacings * spacing, kGapHeight * height_of(points));
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
        if (draft.tree.parent[n] != kNone && draft.belief.measured[n] < 0.5)
            out.report.presumed +=
                distance(draft.tree.position[n], draft.tree.position[draft.tree.parent[n]]);
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
};

PathCloud make_path_cloud(const Cloud& cloud, const CloudOptions& options, const Context& ctx) {
    PathCloud out{local_spacing(cloud.near, kSpacingRank), {}};
    out.graph = connect_points(cloud.points, cloud.near, cloud.outlier,
                               gap_of(cloud.points, median(out.spacing), options), ctx);
    return out;
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

Rough rough_draft(const Cloud& cloud, const PathCloud& paths, const CloudOptions& options,
                  std::optional<Vec3d> root, const Context& ctx) {
    const auto& [graph, parts, bridges] = paths.graph;
    Rough out{find_roots(cloud.points, graph, parts, {median(paths.spacing), root, options.max_trees}, ctx),
              {}};
    if (out.bases.empty())
        throw InvalidInput("extract: no part of the cloud is large enough for a tree; set root");
    CloudTree tubes = find_tubes(cloud.points, graph, out.bases, paths.spacing,
                                 {options.step, options.fit_passes}, part_of(ctx, 0, kTubesFound));
    FitSamples samples{cloud.points, {}, {tubes.node_of_point.begin(), tubes.node_of_point.end()}};
    out.draft = draft_from_cloud(std::move(tubes), std::move(samples),
                                 {graph, out.bases, paths.spacing, {options.step, options.twig}},
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
    Cloud cloud{clean_cloud(set, options, cleaning, ctx), {}, {}};
    ctx.report(kCleaned);
    cloud.near = nearest_neighbours(cloud.points, static_cast<std::uint32_t>(options.neighbours), ctx);
    ctx.report(kNeighboursFound);
    cloud.outlier.assign(cloud.points.size(), 0);
    if (options.outlier_factor > 0) cloud.outlier = find_outliers(cloud.near, options.outlier_factor, ctx);
    cleaning.outliers = static_cast<std::uint64_t>(std::ranges::count(cloud.outlier, 1));

    std::optional<Vec3d> root;
    if (options.root) root = *options.root - set.origin;
    const PathCloud paths = make_path_cloud(cloud, options, ctx);
    cleaning.spacing = median(paths.spacing);
    std::vector<std::uint8_t> leaf;
    if (options.leaves != LeafRule::keep) {
        const double gap = gap_of(cloud.points, cleaning.spacing, options);
        leaf = find_leaves(cloud.points, cloud.near, cloud.outlier,
                           {options.leaves == LeafRule::drop, gap, root}, ctx);
        cleaning.leaves = static_cast<std::uint64_t>(std::ranges::count(leaf, 1));
    }
    ctx.report(kLeavesSplit);
    Rough rough;
    if (cleaning.leaves == 0) {
        rough = rough_draft(cloud, paths, options, root, part_of(ctx, kLeavesSplit, kDrafted));
    } else {
        const Wood wood = wood_of(cloud, leaf, ctx);
        rough = rough_draft(wood, make_path_cloud(wood, options, ctx), options, root,
                            part_of(ctx, kLeavesSplit, kDrafted));
        place_among(rough, cloud.points, wood.place);
    }
    const DraftOptions wanted{options.step, options.twig, detail_of(cloud.points, options)};
    settle_draft(rough.draft, {paths.graph.graph, rough.bases, paths.spacing, wanted, leaf},
                 part_of(ctx, kDrafted, 1));
    cleaning.unreached = cloud.points.size() - cleaning.outliers - rough.draft.reached;
    CloudExtraction out{result_of(rough.draft, set.origin, ctx), cleaning, {{}, set.origin}};
    for (std::size_t p = 0; p < leaf.size(); ++p)
        if (leaf[p]) out.leaves.positions.push_back(cloud.points[p]);
    out.report.joined = paths.graph.bridges;
    ctx.report(1);
    return out;
}

}  // namespace coppice
