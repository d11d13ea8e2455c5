#include "coppice/extract/cloud/draft_internal.h"

#include <algorithm>
#include <limits>

#include "coppice/base/median.h"
#include "coppice/extract/cloud/clean_internal.h"
#include "coppice/extract/stage_internal.h"
#include "coppice/extract/tree/draft_edit_internal.h"
#include "coppice/extract/tree/simplify_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr int kRounds = 3;
constexpr int kLongFit = 8, kShortFit = 4;                          // iterations
constexpr float kFitted = 0.08f, kJoined = 0.2f, kRefined = 0.97f;  // of the time, by then
constexpr double kRobust = 0.5;      // [radius] residuals much larger than this hardly count
constexpr double kTolerance = 0.02;  // [radius] to which nodes are needed
constexpr double kLeast = 0.05;      // [spacing] median: no radius is less, which nothing could tell
constexpr double kClubEnd = 1.5;     // [radius] of what bears it, as far as a club is thicker than this

void fit(CloudDraft& draft, int iterations, const Context& ctx) {
    FitOptions options;
    options.iterations = iterations;
    options.robust = kRobust;
    fit_capsules(draft.tree, draft.samples, options, ctx);
}

/// Points of a foot that no segment has belong to the root that is nearest.
void claim_feet(CloudDraft& draft, Feet feet) {
    std::vector<std::uint32_t> roots;
    for (std::uint32_t n = 0; n < draft.tree.size(); ++n)
        if (draft.tree.parent[n] == kNone) roots.push_back(n);
    for (const auto& foot : feet) {
        const Vec3d place(draft.samples.positions[foot[0]]);
        std::uint32_t best = kNone;
        double least = std::numeric_limits<double>::infinity();
        for (const std::uint32_t n : roots) {
            const double d = length_squared(draft.tree.position[n] - place);
            if (best != kNone && !(d < least)) continue;
            least = d;
            best = n;
        }
        for (const std::uint32_t p : foot)
            if (draft.samples.node[p] == kNone) draft.samples.node[p] = best;
    }
}

/// The greatest radius on the way down from a node, as far as a club of its thickness is long; infinite when
/// that comes to the root.
double radius_below(const DraftTree& tree, std::uint32_t n) {
    double most = 0, way = 0;
    for (std::uint32_t m = n; way < kStout * tree.radius[n];) {
        const std::uint32_t below = tree.parent[m];
        if (below == kNone || tree.parent[below] == kNone) return std::numeric_limits<double>::infinity();
        most = std::max(most, tree.radius[below]);
        way += distance(tree.position[m], tree.position[below]);
        m = below;
    }
    return most;
}

}  // namespace

void slim_clubs(DraftTree& tree) {
    const DraftLinks links(tree);
    std::vector<std::uint32_t> club;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (tree.parent[n] == kNone || tree.radius[n] <= kThickerThanBearer * tree.radius[tree.parent[n]])
            continue;
        const double below = radius_below(tree, n);
        if (tree.radius[n] <= kThickerThanBearer * below) continue;
        club.clear();
        double way = 0;
        for (std::uint32_t m = n; m != kNone && tree.radius[m] > kClubEnd * below; m = links.leader(m)) {
            way += distance(tree.position[m], tree.position[tree.parent[m]]);
            club.push_back(m);
        }
        if (way >= kStout * tree.radius[n]) continue;
        for (const std::uint32_t m : club) tree.radius[m] = below;
    }
}

CloudDraft draft_from_cloud(DraftTree tubes, FitSamples samples, const Graph& graph, Feet feet,
                            std::span<const float> spacing, const DraftOptions& options, const Context& ctx) {
    CloudDraft draft{std::move(tubes), std::move(samples)};
    if (draft.tree.size() > 0) {
        fit(draft, kLongFit, stage_context(ctx, 0, kFitted));
        claim_points(draft.tree, draft.samples, spacing, ctx);
    }
    draft.reached = join_tubes(draft.tree, draft.samples, graph, feet, spacing, options, ctx);
    settle_forks(draft.tree, draft.samples, ctx);
    fit(draft, kLongFit, stage_context(ctx, kFitted, kJoined));
    extract_internal::extend_ends(draft.tree, draft.samples);
    for (int k = 0; k < kRounds; ++k) {
        const float share = (kRefined - kJoined) / kRounds, start = kJoined + static_cast<float>(k) * share;
        const Context round = stage_context(ctx, start, start + share);
        ctx.throw_if_cancelled();
        const Cover cover = claim_points(draft.tree, draft.samples, spacing, ctx);
        claim_feet(draft, feet);
        grow_chains(draft.tree, draft.samples, graph, spacing, cover, options, ctx);
        settle_forks(draft.tree, draft.samples, ctx);
        fit(draft, kLongFit, stage_context(round, 0.3f, 0.7f));
        simplify(draft.tree, draft.samples, kTolerance);
        draft.dropped += drop_needless(draft.tree, draft.samples, spacing, cover.noise, ctx);
        settle_forks(draft.tree, draft.samples, ctx);
        fit(draft, kShortFit, stage_context(round, 0.8f, 1));
        draft.ends = extract_internal::extend_ends(draft.tree, draft.samples);
    }
    slim_clubs(draft.tree);
    const double least = kLeast * double{median(spacing)};
    for (double& r : draft.tree.radius) r = std::max(r, least);
    simplify(draft.tree, draft.samples, kTolerance);
    settle_forks(draft.tree, draft.samples, ctx);
    simplify(draft.tree, draft.samples, kTolerance);
    claim_points(draft.tree, draft.samples, spacing, ctx);
    return draft;
}

}  // namespace coppice::extract_internal
