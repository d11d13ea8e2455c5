#include <algorithm>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/median.h"
#include "coppice/extract/cloud/initial_tree_internal.h"
#include "coppice/extract/prior/smooth_axes_internal.h"
#include "coppice/extract/tree/simplify_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kThick = 1.2;
constexpr double kHollow = 0.25;  // [radius] and [spacing]: distance of points from the axis of a hollow node

/// Assigns points except leaves to segments.
PointDistances assign_wood(FittedTree& initial, const CloudInput& cloud, const Context& ctx) {
    PointDistances distances = assign_points(initial.tree, initial.samples, cloud.spacing, ctx);
    for (std::size_t p = 0; p < cloud.leaf.size(); ++p)
        if (cloud.leaf[p]) initial.samples.node[p] = kNoIndex;
    return distances;
}

std::vector<NodeEvidence> compute_evidence(const FittedTree& initial, const CloudInput& cloud,
                                           const Context& ctx) {
    return gather_evidence(initial.tree, initial.samples, cloud.spacing, ctx);
}

/// Returns the nodes with points far outside the estimated radius, which disagrees with the measured one.
std::vector<char> hollow_nodes(const InitialTree& believed, std::span<const NodeEvidence> evidence,
                               const RadiusEstimate& estimate) {
    std::vector<char> hollow(believed.size(), 0);
    for (std::uint32_t n = 0; n < believed.size(); ++n) {
        if (believed.fixed[n]) continue;
        const double most = kThick * believed.radius[n] + kHollow * evidence[n].spacing;
        hollow[n] = evidence[n].radius > most && estimate.measured[n] < 0.5;
    }
    return hollow;
}

/// Removes nodes; their descendants become loose. Isolated nodes are also removed, but roots remain, with the
/// segment above them. Returns the roots.
std::vector<std::uint32_t> cut_out(FittedTree& initial, std::vector<char> gone) {
    InitialTree& tree = initial.tree;
    const InitialTreeLinks links(tree);
    std::vector<std::uint32_t> roots = find_roots(tree);
    std::vector<char> joined(tree.size(), 0);
    for (const std::uint32_t root : roots) {
        joined[root] = 1;
        gone[root] = 0;
        if (!links.is_tip(root)) gone[links.leader(root)] = 0;
    }
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        std::uint32_t& q = tree.parent[n];
        if (q != kNoIndex && (gone[n] || gone[q])) q = kNoIndex;
        if (q != kNoIndex) joined[n] = joined[q] = 1;
    }
    for (std::uint32_t n = 0; n < tree.size(); ++n) gone[n] = !joined[n];
    const auto new_of_old = sort_parents_first(tree, gone);
    for (std::uint32_t& n : initial.samples.node)
        if (n != kNoIndex) n = gone[n] ? kNoIndex : new_of_old[n];
    for (std::uint32_t& root : roots) root = new_of_old[root];
    return roots;
}

/// Assigns all points that need no twig of their own to segments nearby. Twigs cannot be detected among
/// leaves: one is added to the middle of a cluster, not to each of its points.
PointDistances cover_points(FittedTree& initial, const CloudInput& cloud, const Context& ctx) {
    Tolerance covered{InitialTreeOptions{}.cover, 1};
    if (!cloud.leaf.empty()) covered.metres = cloud.options.detail;
    return assign_points(initial.tree, initial.samples, cloud.next, ctx, covered);
}

/// Removes nodes with points farther out than any plausible radius: clusters of leaves and bundles of twigs
/// mistaken for thick branches. The remaining tubes are attached along paths again, and thin axes continue to
/// points farther than a spacing and a radius from all of them. Radii become the estimated ones.
void lead_through_unresolved(FittedTree& initial, const CloudInput& cloud, const Context& ctx) {
    const auto evidence = compute_evidence(initial, cloud, ctx);
    const RadiusEstimate estimate = believe_radii(initial.tree, evidence, cloud.options.area_limit);
    const std::vector<std::uint32_t> roots = cut_out(initial, hollow_nodes(initial.tree, evidence, estimate));
    // Paths start at the stem bases, which are therefore assigned to the trees there.
    for (const auto& base : cloud.bases)
        for (const std::uint32_t p : base) initial.samples.node[p] = kNoIndex;
    assign_stem_bases(initial, cloud.bases, roots);
    // Twigs have the same minimum length where points are sparse.
    Buffer<float> spacing(cloud.spacing.begin(), cloud.spacing.end());
    const float most = median(cloud.spacing);
    for (float& s : spacing) s = std::min(s, most);
    CloudInput unresolved = cloud;
    unresolved.spacing = spacing;
    unresolved.options.narrow = true;
    initial.reached = attach_tubes(initial.tree, initial.samples, unresolved, roots, false, ctx);
    const PointDistances distances = cover_points(initial, cloud, ctx);
    assign_stem_bases(initial, cloud.bases, find_roots(initial.tree));
    grow_chains(initial.tree, initial.samples, unresolved, distances, ctx);
    assign_wood(initial, cloud, ctx);
}

/// Moves nodes to smooth the axes.
void smooth(FittedTree& initial, const CloudInput& cloud, const Context& ctx) {
    smooth_axes(initial.tree, compute_evidence(initial, cloud, ctx), ctx);
    assign_wood(initial, cloud, ctx);
}

}  // namespace

void finalize_tree(FittedTree& initial, const CloudInput& cloud, const Context& ctx) {
    smooth(initial, cloud, ctx);
    lead_through_unresolved(initial, cloud, ctx);
    // A fit shows whether the new axes are twigs after all.
    fit_initial_tree(initial, kShortFit, ctx);
    simplify(initial.tree, initial.samples, kNodeTolerance);
    const PointDistances distances = assign_wood(initial, cloud, ctx);
    initial.pruned += prune_redundant(initial.tree, initial.samples, cloud.spacing, distances.noise, ctx);
    lead_through_unresolved(initial, cloud, ctx);
    smooth(initial, cloud, ctx);
    initial.estimate =
        believe_radii(initial.tree, compute_evidence(initial, cloud, ctx), cloud.options.area_limit);
    assign_wood(initial, cloud, ctx);
}

}  // namespace coppice::extract_internal
