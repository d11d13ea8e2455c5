#include "coppice/extract/cloud/initial_tree_internal.h"

#include <algorithm>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/base/median.h"
#include "coppice/base/progress.h"
#include "coppice/extract/points/clean_internal.h"
#include "coppice/extract/tree/simplify_internal.h"
#include "coppice/extract/tree/tree_edit_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr int kRounds = 3;
constexpr int kLongFit = 8;                                           // iterations
constexpr float kFitted = 0.08f, kAttached = 0.2f, kRefined = 0.97f;  // progress at the end of stages
// [radius] scale of the robust weight; much larger residuals have little influence
constexpr double kRobust = 0.5;
constexpr double kMin = 0.05;         // [median spacing] minimum radius; smaller ones cannot be measured
constexpr double kSwellingEnd = 1.5;  // [radius of the supporting branch] minimum radius of a swelling

/// Returns the maximum radius rootward of a node over the length of a swelling of its thickness; infinity if
/// that includes the root.
double radius_rootward(const InitialTree& tree, std::uint32_t n) {
    double most = 0, way = 0;
    for (std::uint32_t m = n; way < kStout * tree.radius[n];) {
        const std::uint32_t parent = tree.parent[m];
        if (parent == kNoIndex || tree.parent[parent] == kNoIndex)
            return std::numeric_limits<double>::infinity();
        most = std::max(most, tree.radius[parent]);
        way += distance(tree.position[m], tree.position[parent]);
        m = parent;
    }
    return most;
}

/// Performs one round: adds missing branches, fits, and prunes redundant ones.
void refine(FittedTree& initial, const CloudInput& cloud, const Context& ctx) {
    const PointDistances distances = assign_points(initial.tree, initial.samples, cloud.spacing, ctx);
    assign_stem_bases(initial, cloud.bases, find_roots(initial.tree));
    grow_chains(initial.tree, initial.samples, cloud, distances, ctx);
    reattach_laterals(initial.tree, initial.samples, ctx);
    fit_initial_tree(initial, kLongFit, narrow_progress(ctx, 0.3f, 0.7f));
    simplify(initial.tree, initial.samples, kNodeTolerance);
    initial.pruned += prune_redundant(initial.tree, initial.samples, cloud.spacing, distances.noise, ctx);
    reattach_laterals(initial.tree, initial.samples, ctx);
    fit_initial_tree(initial, kShortFit, narrow_progress(ctx, 0.8f, 1));
    initial.ends = extend_ends(initial.tree, initial.samples);
}

}  // namespace

void fit_initial_tree(FittedTree& initial, int iterations, const Context& ctx) {
    FitOptions options;
    options.iterations = iterations;
    options.robust = kRobust;
    fit_capsules(initial.tree, initial.samples, options, ctx);
}

std::vector<std::uint32_t> find_roots(const InitialTree& tree) {
    std::vector<std::uint32_t> roots;
    for (std::uint32_t n = 0; n < tree.size(); ++n)
        if (tree.parent[n] == kNoIndex) roots.push_back(n);
    return roots;
}

void assign_stem_bases(FittedTree& initial, StemBases bases, std::span<const std::uint32_t> roots) {
    for (const auto& base : bases) {
        const Vec3d place(initial.samples.positions[base[0]]);
        std::uint32_t best = kNoIndex;
        double least = std::numeric_limits<double>::infinity();
        for (const std::uint32_t n : roots) {
            const double d = length_squared(initial.tree.position[n] - place);
            if (best != kNoIndex && !(d < least)) continue;
            least = d;
            best = n;
        }
        for (const std::uint32_t p : base)
            if (initial.samples.node[p] == kNoIndex) initial.samples.node[p] = best;
    }
}

void correct_swollen_radii(InitialTree& tree) {
    const InitialTreeLinks links(tree);
    std::vector<std::uint32_t> swelling;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (tree.parent[n] == kNoIndex || tree.radius[n] <= kThickerThanBearer * tree.radius[tree.parent[n]])
            continue;
        const double bearing = radius_rootward(tree, n);
        if (tree.radius[n] <= kThickerThanBearer * bearing) continue;
        swelling.clear();
        double way = 0;
        for (std::uint32_t m = n; m != kNoIndex && tree.radius[m] > kSwellingEnd * bearing;
             m = links.leader(m)) {
            way += distance(tree.position[m], tree.position[tree.parent[m]]);
            swelling.push_back(m);
        }
        if (way >= kStout * tree.radius[n]) continue;
        for (const std::uint32_t m : swelling) tree.radius[m] = bearing;
    }
}

FittedTree build_initial_tree(InitialTree tubes, FitSamples samples, const CloudInput& cloud,
                              const Context& ctx) {
    FittedTree initial{std::move(tubes), std::move(samples)};
    if (initial.tree.size() > 0) {
        fit_initial_tree(initial, kLongFit, narrow_progress(ctx, 0, kFitted));
        assign_points(initial.tree, initial.samples, cloud.spacing, ctx);
    }
    std::vector<std::uint32_t> stems = find_roots(initial.tree);
    std::erase_if(stems, [&](std::uint32_t n) { return !initial.tree.fixed[n]; });
    initial.reached = attach_tubes(initial.tree, initial.samples, cloud, stems, true, ctx);
    reattach_laterals(initial.tree, initial.samples, ctx);
    fit_initial_tree(initial, kLongFit, narrow_progress(ctx, kFitted, kAttached));
    extend_ends(initial.tree, initial.samples);
    for (int k = 0; k < kRounds; ++k) {
        const float share = (kRefined - kAttached) / kRounds,
                    start = kAttached + static_cast<float>(k) * share;
        refine(initial, cloud, narrow_progress(ctx, start, start + share));
    }
    correct_swollen_radii(initial.tree);
    const double least = kMin * double{median(cloud.spacing)};
    for (double& r : initial.tree.radius) r = std::max(r, least);
    simplify(initial.tree, initial.samples, kNodeTolerance);
    reattach_laterals(initial.tree, initial.samples, ctx);
    simplify(initial.tree, initial.samples, kNodeTolerance);
    assign_points(initial.tree, initial.samples, cloud.spacing, ctx);
    return initial;
}

}  // namespace coppice::extract_internal
