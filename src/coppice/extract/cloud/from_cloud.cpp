#include "coppice/extract/cloud/from_cloud.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/median.h"
#include "coppice/extract/cloud/clean_internal.h"
#include "coppice/extract/cloud/draft_internal.h"
#include "coppice/extract/cloud/graph_internal.h"
#include "coppice/extract/cloud/leaves_internal.h"
#include "coppice/extract/cloud/tubes_internal.h"
#include "coppice/extract/stage_internal.h"
#include "coppice/extract/tree/draft_edit_internal.h"

namespace coppice {
namespace {

using namespace extract_internal;

constexpr std::size_t kFewestPoints = 20;
constexpr std::uint32_t kSpacingRank = 4;  // the neighbour whose distance is taken for the spacing
constexpr double kGapSpacings = 10;        // widest gap that is bridged, where the user says nothing
constexpr double kGapHeight = 0.03;        // the same, of the height of the cloud
// The share of the time that has gone by then, on clouds of trees.
constexpr float kCleaned = 0.005f, kNeighboursFound = 0.04f, kLeavesSplit = 0.1f, kRootsFound = 0.11f,
                kTubesFound = 0.52f, kDrafted = 0.99f;

void check_count(std::size_t count, const char* what) {
    if (count >= kFewestPoints) return;
    throw InvalidInput(fmt::format("extract: {} points are left {}, but a skeleton needs at least {}", count,
                                   what, kFewestPoints));
}

std::uint64_t erase_ground(Buffer<Vec3>& points, Vec3d origin, const CloudOptions& options) {
    const std::size_t before = points.size();
    if (options.ground == GroundRule::height) {
        const double height = double{options.ground_height} - origin.z;
        std::erase_if(points, [&](Vec3 p) { return p.z < height; });
    } else if (options.ground == GroundRule::automatic) {
        const Ground ground = find_ground(points);
        if (ground.found) {
            std::erase_if(points, [&](Vec3 p) { return p.z < ground.height(p.x, p.y) + ground.clearance; });
        }
    }
    return before - points.size();
}

/// The points that can be wood, sorted in space.
Buffer<Vec3> clean(const PointSet& set, const CloudOptions& options, CloudReport& report,
                   const Context& ctx) {
    report.points = set.size();
    check_count(set.size(), "in the cloud");
    if (set.size() > std::numeric_limits<std::uint32_t>::max() / 2) {
        throw InvalidInput(
            fmt::format("extract: {} points are too many; thin the cloud to 2^31 first", set.size()));
    }
    Buffer<Vec3> points = sorted_without_duplicates(set.positions, ctx);
    report.duplicates = set.size() - points.size();
    ctx.throw_if_cancelled();
    const std::size_t whole = points.size();
    if (options.voxel > 0) points = thinned(points, options.voxel, ctx);
    points = thinned_to(std::move(points), static_cast<std::size_t>(options.max_points), ctx);
    report.thinned = whole - points.size();
    report.ground = erase_ground(points, set.origin, options);
    check_count(points.size(), "after cleaning");
    ctx.report(kCleaned);
    return points;
}

double gap_of(std::span<const Vec3> points, double spacing, const CloudOptions& options) {
    if (options.gap > 0) return options.gap;
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    return std::max(kGapSpacings * spacing, kGapHeight * double{box.size().z});
}

}  // namespace

CloudExtraction extract_from_cloud(const PointSet& set, const CloudOptions& options, const Context& ctx) {
    check_fields(options, "extract");
    CloudReport cleaning;
    Buffer<Vec3> points = clean(set, options, cleaning, ctx);
    Neighbours near = nearest_neighbours(points, static_cast<std::uint32_t>(options.neighbours), ctx);
    ctx.report(kNeighboursFound);
    std::vector<std::uint8_t> stray(points.size(), 0);
    if (options.stray > 0) stray = strays(near, options.stray, ctx);
    cleaning.strays = static_cast<std::uint64_t>(std::ranges::count(stray, 1));
    std::optional<Vec3d> root;
    if (options.root) root = *options.root - set.origin;
    Buffer<Vec3> leaves;
    if (options.leaves != LeafRule::keep) {
        const double gap = gap_of(points, median(local_spacing(near, kSpacingRank)), options);
        leaves = split_leaves(points, near, stray, {options.leaves == LeafRule::drop, gap, root}, ctx);
        cleaning.leaves = leaves.size();
        check_count(points.size(), "beside leaves");
    }
    ctx.report(kLeavesSplit);
    const Buffer<float> spacing = local_spacing(near, kSpacingRank);
    cleaning.spacing = median(spacing);

    Graph graph = make_graph(near, stray, {}, ctx);
    Components parts = components(graph, ctx);
    const auto bridges = bridge_gaps(points, stray, parts, gap_of(points, cleaning.spacing, options), ctx);
    if (!bridges.empty()) {
        graph = make_graph(near, stray, bridges, ctx);
        parts = components(graph, ctx);
    }
    const auto feet = find_roots(points, graph, parts, cleaning.spacing, root, options.max_trees, ctx);
    if (feet.empty())
        throw InvalidInput("extract: no part of the cloud is large enough for a tree; set root");
    ctx.report(kRootsFound);

    CloudTree tubes = find_tubes(points, graph, feet, spacing, {options.step, options.fit_passes},
                                 stage_context(ctx, kRootsFound, kTubesFound));
    FitSamples samples{points, {}, {tubes.node_of_point.begin(), tubes.node_of_point.end()}};
    const CloudDraft draft =
        draft_from_cloud(std::move(tubes), std::move(samples), graph, feet, spacing,
                         {options.step, options.twig}, stage_context(ctx, kTubesFound, kDrafted));
    cleaning.unreached = points.size() - cleaning.strays - draft.reached;
    CloudExtraction out{
        {to_skeleton(draft.tree, set.origin), {}, {}}, cleaning, {std::move(leaves), set.origin}};
    out.confidence = extract_internal::rate_nodes(draft.tree, draft.samples, out.report.residual, ctx);
    for (const NodeConfidence& c : out.confidence) out.report.samples += c.samples;
    out.report.trees = out.skeleton.tree_count();
    out.report.components = out.report.trees;
    out.report.joined = static_cast<std::uint32_t>(bridges.size());
    out.report.pruned_twigs = draft.dropped;
    out.report.repaired_tips = draft.ends;
    ctx.report(1);
    return out;
}

}  // namespace coppice
