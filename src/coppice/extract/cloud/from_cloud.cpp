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
// The share of the time that has gone by then, on clouds of trees.
constexpr float kCleaned = 0.005f, kNeighboursFound = 0.04f, kLeavesSplit = 0.1f, kRootsFound = 0.11f,
                kTubesFound = 0.52f, kDrafted = 0.99f;

double gap_of(std::span<const Vec3> points, double spacing, const CloudOptions& options) {
    if (options.gap > 0) return options.gap;
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    return std::max(kGapSpacings * spacing, kGapHeight * double{box.size().z});
}

ExtractResult result_of(const CloudDraft& draft, Vec3d origin, const Context& ctx) {
    ExtractResult out{to_skeleton(draft.tree, origin), {}, {}};
    out.confidence = rate_nodes(draft.tree, draft.samples, out.report.residual, ctx);
    for (const NodeConfidence& c : out.confidence) out.report.samples += c.samples;
    out.report.trees = out.skeleton.tree_count();
    out.report.components = out.report.trees;
    out.report.pruned_twigs = draft.pruned;
    out.report.repaired_tips = draft.ends;
    return out;
}

}  // namespace

CloudExtraction extract_from_cloud(const PointSet& set, const CloudOptions& options, const Context& ctx) {
    check_fields(options, "extract");
    CloudReport cleaning;
    Buffer<Vec3> points = clean_cloud(set, options, cleaning, ctx);
    ctx.report(kCleaned);
    Neighbours near = nearest_neighbours(points, static_cast<std::uint32_t>(options.neighbours), ctx);
    ctx.report(kNeighboursFound);
    std::vector<std::uint8_t> outlier(points.size(), 0);
    if (options.outlier_factor > 0) outlier = find_outliers(near, options.outlier_factor, ctx);
    cleaning.outliers = static_cast<std::uint64_t>(std::ranges::count(outlier, 1));

    std::optional<Vec3d> root;
    if (options.root) root = *options.root - set.origin;
    Buffer<Vec3> leaves;
    if (options.leaves != LeafRule::keep) {
        const double gap = gap_of(points, median(local_spacing(near, kSpacingRank)), options);
        leaves = split_leaves(points, near, outlier, {options.leaves == LeafRule::drop, gap, root}, ctx);
        cleaning.leaves = leaves.size();
        check_point_count(points.size(), "beside leaves");
    }
    ctx.report(kLeavesSplit);

    const Buffer<float> spacing = local_spacing(near, kSpacingRank);
    cleaning.spacing = median(spacing);
    const auto [graph, parts, bridges] =
        connect_points(points, near, outlier, gap_of(points, cleaning.spacing, options), ctx);
    const auto bases = find_roots(points, graph, parts, {cleaning.spacing, root, options.max_trees}, ctx);
    if (bases.empty())
        throw InvalidInput("extract: no part of the cloud is large enough for a tree; set root");
    ctx.report(kRootsFound);

    CloudTree tubes = find_tubes(points, graph, bases, spacing, {options.step, options.fit_passes},
                                 part_of(ctx, kRootsFound, kTubesFound));
    FitSamples samples{points, {}, {tubes.node_of_point.begin(), tubes.node_of_point.end()}};
    const CloudDraft draft = draft_from_cloud(std::move(tubes), std::move(samples),
                                              {graph, bases, spacing, {options.step, options.twig}},
                                              part_of(ctx, kTubesFound, kDrafted));
    cleaning.unreached = points.size() - cleaning.outliers - draft.reached;
    CloudExtraction out{result_of(draft, set.origin, ctx), cleaning, {std::move(leaves), set.origin}};
    out.report.joined = bridges;
    ctx.report(1);
    return out;
}

}  // namespace coppice
