#include <algorithm>
#include <vector>

#include "coppice/base/median.h"
#include "coppice/extract/cloud/draft_internal.h"
#include "coppice/extract/prior/smooth_axes_internal.h"
#include "coppice/extract/tree/simplify_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kThick = 1.2, kHollow = 0.25;  // [radius], and [spacing], that points lie from the axis

/// Leaves near an axis are none of its points.
PointDistances assign_wood(CloudDraft& draft, const DraftCloud& cloud, const Context& ctx) {
    PointDistances distances = assign_points(draft.tree, draft.samples, cloud.spacing, ctx);
    for (std::size_t p = 0; p < cloud.leaf.size(); ++p)
        if (cloud.leaf[p]) draft.samples.node[p] = kNone;
    return distances;
}

std::vector<NodeEvidence> evidence_of(const CloudDraft& draft, const DraftCloud& cloud, const Context& ctx) {
    return gather_evidence(draft.tree, draft.samples, cloud.spacing, ctx);
}

/// The nodes whose points lie far outside of the radius that is believed, against what they say themselves.
std::vector<char> hollow_nodes(const DraftTree& believed, std::span<const NodeEvidence> evidence,
                               const RadiusBelief& belief) {
    std::vector<char> hollow(believed.size(), 0);
    for (std::uint32_t n = 0; n < believed.size(); ++n) {
        if (believed.fixed[n]) continue;
        const double most = kThick * believed.radius[n] + kHollow * evidence[n].spacing;
        hollow[n] = evidence[n].radius > most && belief.measured[n] < 0.5;
    }
    return hollow;
}

/// Takes nodes away; what hangs on them becomes loose. Single nodes go too, but roots stay, with the segment
/// that stands on them. Returns the roots.
std::vector<std::uint32_t> cut_out(CloudDraft& draft, std::vector<char> gone) {
    DraftTree& tree = draft.tree;
    const DraftLinks links(tree);
    std::vector<std::uint32_t> roots = roots_of(tree);
    std::vector<char> joined(tree.size(), 0);
    for (const std::uint32_t root : roots) {
        joined[root] = 1;
        gone[root] = 0;
        if (!links.is_tip(root)) gone[links.leader(root)] = 0;
    }
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        std::uint32_t& q = tree.parent[n];
        if (q != kNone && (gone[n] || gone[q])) q = kNone;
        if (q != kNone) joined[n] = joined[q] = 1;
    }
    for (std::uint32_t n = 0; n < tree.size(); ++n) gone[n] = !joined[n];
    const auto new_of_old = sort_parents_first(tree, gone);
    for (std::uint32_t& n : draft.samples.node)
        if (n != kNone) n = gone[n] ? kNone : new_of_old[n];
    for (std::uint32_t& root : roots) root = new_of_old[root];
    return roots;
}

/// Gives all points that need no twig of their own to what is near. Amid leaves nothing tells twigs: one
/// leads to the middle of a cluster, not to each point of it.
PointDistances cover_points(CloudDraft& draft, const DraftCloud& cloud, const Context& ctx) {
    Tolerance covered{DraftOptions{}.cover, 1};
    if (!cloud.leaf.empty()) covered.metres = cloud.options.detail;
    return assign_points(draft.tree, draft.samples, cloud.spacing, ctx, covered);
}

/// Takes away what points lie about farther out than any radius that is to be believed there: clusters of
/// leaves and bundles of twigs taken for thick branches. What stays is attached along paths again, and thin
/// axes lead on to what is farther than a spacing and a radius from all of them. Radii become those that are
/// believed.
void lead_through_unresolved(CloudDraft& draft, const DraftCloud& cloud, const Context& ctx) {
    const auto evidence = evidence_of(draft, cloud, ctx);
    const RadiusBelief belief = believe_radii(draft.tree, evidence, cloud.options.area_limit);
    const std::vector<std::uint32_t> roots = cut_out(draft, hollow_nodes(draft.tree, evidence, belief));
    // Paths start at the stem bases, which therefore belong to the trees that stand there.
    for (const auto& base : cloud.bases)
        for (const std::uint32_t p : base) draft.samples.node[p] = kNone;
    assign_stem_bases(draft, cloud.bases, roots);
    // Where points are sparse, twigs are as short as elsewhere.
    Buffer<float> spacing(cloud.spacing.begin(), cloud.spacing.end());
    const float most = median(cloud.spacing);
    for (float& s : spacing) s = std::min(s, most);
    DraftCloud unresolved = cloud;
    unresolved.spacing = spacing;
    unresolved.options.narrow = true;
    draft.reached = attach_tubes(draft.tree, draft.samples, unresolved, roots, false, ctx);
    const PointDistances distances = cover_points(draft, cloud, ctx);
    assign_stem_bases(draft, cloud.bases, roots_of(draft.tree));
    grow_chains(draft.tree, draft.samples, unresolved, distances, ctx);
    assign_wood(draft, cloud, ctx);
}

/// Moves nodes to where axes are smooth.
void smooth(CloudDraft& draft, const DraftCloud& cloud, const Context& ctx) {
    smooth_axes(draft.tree, evidence_of(draft, cloud, ctx), ctx);
    assign_wood(draft, cloud, ctx);
}

}  // namespace

void settle_draft(CloudDraft& draft, const DraftCloud& cloud, const Context& ctx) {
    smooth(draft, cloud, ctx);
    lead_through_unresolved(draft, cloud, ctx);
    // What was found instead may be twigs after all, which a fit shows.
    fit_draft(draft, kShortFit, ctx);
    simplify(draft.tree, draft.samples, kNodeTolerance);
    const PointDistances distances = assign_wood(draft, cloud, ctx);
    draft.pruned += prune_redundant(draft.tree, draft.samples, cloud.spacing, distances.noise, ctx);
    lead_through_unresolved(draft, cloud, ctx);
    smooth(draft, cloud, ctx);
    draft.belief = believe_radii(draft.tree, evidence_of(draft, cloud, ctx), cloud.options.area_limit);
    assign_wood(draft, cloud, ctx);
}

}  // namespace coppice::extract_internal
