#include "coppice/extract/cloud/draft_internal.h"

#include <algorithm>
#include <limits>

#include "coppice/base/median.h"
#include "coppice/base/progress.h"
#include "coppice/extract/points/clean_internal.h"
#include "coppice/extract/tree/draft_edit_internal.h"
#include "coppice/extract/tree/simplify_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr int kRounds = 3;
constexpr int kLongFit = 8;                                           // iterations
constexpr float kFitted = 0.08f, kAttached = 0.2f, kRefined = 0.97f;  // of the time, by then
constexpr double kRobust = 0.5;       // [radius] residuals much larger than this hardly count
constexpr double kLeast = 0.05;       // [spacing] median: no radius is less, which nothing could tell
constexpr double kSwellingEnd = 1.5;  // [radius] of what bears it, as far as a swelling is thicker than this

/// The greatest radius rootward of a node, as far as a swelling of its thickness is long; infinite when that
/// comes to the root.
double radius_rootward(const DraftTree& tree, std::uint32_t n) {
    double most = 0, way = 0;
    for (std::uint32_t m = n; way < kStout * tree.radius[n];) {
        const std::uint32_t parent = tree.parent[m];
        if (parent == kNone || tree.parent[parent] == kNone) return std::numeric_limits<double>::infinity();
        most = std::max(most, tree.radius[parent]);
        way += distance(tree.position[m], tree.position[parent]);
        m = parent;
    }
    return most;
}

/// One round: grows what is missing, fits, and prunes what is too much.
void refine(CloudDraft& draft, const DraftCloud& cloud, const Context& ctx) {
    const PointDistances distances = assign_points(draft.tree, draft.samples, cloud.spacing, ctx);
    assign_stem_bases(draft, cloud.bases, roots_of(draft.tree));
    grow_chains(draft.tree, draft.samples, cloud, distances, ctx);
    reattach_laterals(draft.tree, draft.samples, ctx);
    fit_draft(draft, kLongFit, part_of(ctx, 0.3f, 0.7f));
    simplify(draft.tree, draft.samples, kNodeTolerance);
    draft.pruned += prune_redundant(draft.tree, draft.samples, cloud.spacing, distances.noise, ctx);
    reattach_laterals(draft.tree, draft.samples, ctx);
    fit_draft(draft, kShortFit, part_of(ctx, 0.8f, 1));
    draft.ends = extend_ends(draft.tree, draft.samples);
}

}  // namespace

void fit_draft(CloudDraft& draft, int iterations, const Context& ctx) {
    FitOptions options;
    options.iterations = iterations;
    options.robust = kRobust;
    fit_capsules(draft.tree, draft.samples, options, ctx);
}

std::vector<std::uint32_t> roots_of(const DraftTree& tree) {
    std::vector<std::uint32_t> roots;
    for (std::uint32_t n = 0; n < tree.size(); ++n)
        if (tree.parent[n] == kNone) roots.push_back(n);
    return roots;
}

void assign_stem_bases(CloudDraft& draft, StemBases bases, std::span<const std::uint32_t> roots) {
    for (const auto& base : bases) {
        const Vec3d place(draft.samples.positions[base[0]]);
        std::uint32_t best = kNone;
        double least = std::numeric_limits<double>::infinity();
        for (const std::uint32_t n : roots) {
            const double d = length_squared(draft.tree.position[n] - place);
            if (best != kNone && !(d < least)) continue;
            least = d;
            best = n;
        }
        for (const std::uint32_t p : base)
            if (draft.samples.node[p] == kNone) draft.samples.node[p] = best;
    }
}

void correct_swollen_radii(DraftTree& tree) {
    const DraftLinks links(tree);
    std::vector<std::uint32_t> swelling;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (tree.parent[n] == kNone || tree.radius[n] <= kThickerThanBearer * tree.radius[tree.parent[n]])
            continue;
        const double bearing = radius_rootward(tree, n);
        if (tree.radius[n] <= kThickerThanBearer * bearing) continue;
        swelling.clear();
        double way = 0;
        for (std::uint32_t m = n; m != kNone && tree.radius[m] > kSwellingEnd * bearing;
             m = links.leader(m)) {
            way += distance(tree.position[m], tree.position[tree.parent[m]]);
            swelling.push_back(m);
        }
        if (way >= kStout * tree.radius[n]) continue;
        for (const std::uint32_t m : swelling) tree.radius[m] = bearing;
    }
}

CloudDraft draft_from_cloud(DraftTree tubes, FitSamples samples, const DraftCloud& cloud,
                            const Context& ctx) {
    CloudDraft draft{std::move(tubes), std::move(samples)};
    if (draft.tree.size() > 0) {
        fit_draft(draft, kLongFit, part_of(ctx, 0, kFitted));
        assign_points(draft.tree, draft.samples, cloud.spacing, ctx);
    }
    std::vector<std::uint32_t> stems = roots_of(draft.tree);
    std::erase_if(stems, [&](std::uint32_t n) { return !draft.tree.fixed[n]; });
    draft.reached = attach_tubes(draft.tree, draft.samples, cloud, stems, true, ctx);
    reattach_laterals(draft.tree, draft.samples, ctx);
    fit_draft(draft, kLongFit, part_of(ctx, kFitted, kAttached));
    extend_ends(draft.tree, draft.samples);
    for (int k = 0; k < kRounds; ++k) {
        const float share = (kRefined - kAttached) / kRounds,
                    start = kAttached + static_cast<float>(k) * share;
        refine(draft, cloud, part_of(ctx, start, start + share));
    }
    correct_swollen_radii(draft.tree);
    const double least = kLeast * double{median(cloud.spacing)};
    for (double& r : draft.tree.radius) r = std::max(r, least);
    simplify(draft.tree, draft.samples, kNodeTolerance);
    reattach_laterals(draft.tree, draft.samples, ctx);
    simplify(draft.tree, draft.samples, kNodeTolerance);
    assign_points(draft.tree, draft.samples, cloud.spacing, ctx);
    return draft;
}

}  // namespace coppice::extract_internal
