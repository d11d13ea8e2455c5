#include "coppice/extract/prior/evidence_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/id.h"
#include "coppice/extract/tree/tree_edit_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr int kWindow = 3;        // number of nodes on either side that contribute points of the same branch
constexpr double kBorrowed = 2;   // maximum number of points of neighbours per own point
constexpr double kFreedom = 3;    // number of free parameters of a fit (position and radius)
constexpr double kFilled = 0.33;  // [radius] scatter halfway between a tube and a filled disc
constexpr double kFewPoints = 3;  // number of pseudo-points with the scatter of a filled disc
constexpr double kDiscScatter = 0.35;  // [mean distance] scatter of a filled disc
constexpr double kOfSpacing = 0.12;    // [spacing] error of the radius from a single point
constexpr double kMinError = 0.02;     // minimum error of the logarithm of any radius
constexpr double kFixedError = 0.003;  // error of the logarithm of a fixed radius
constexpr double kMinRadius = 0.1;     // [previous radius] minimum estimate

/// Weighted sums over samples of their distance from the surface.
struct Sums {
    double weight = 0, off = 0, squared = 0, spacing = 0;

    void add(double w, double d, double s) {
        weight += w;
        off += w * d;
        squared += w * d * d;
        spacing += w * s;
    }
    void add(const Sums& b) {
        weight += b.weight;
        off += b.off;
        squared += b.squared;
        spacing += b.spacing;
    }
};

struct SegmentSums {
    Sums upper, lower;  ///< sums of its parent and of its own node
};

SegmentSums sum_segment(const RoundCone& cone, bool tapers, std::span<const std::uint32_t> members,
                        const FitSamples& samples, std::span<const float> spacing) {
    SegmentSums out;
    for (const std::uint32_t i : members) {
        const RoundCone::ClosestPoint closest = cone.closest_point(Vec3d(samples.positions[i]));
        const double share = tapers ? closest.t : 1;
        out.lower.add(share, closest.signed_distance(), double{spacing[i]});
        out.upper.add(1 - share, closest.signed_distance(), double{spacing[i]});
    }
    return out;
}

/// Returns the sums of every node, from the adjacent halves of its segments.
std::vector<Sums> sums_of_nodes(const InitialTree& tree, const FitSamples& samples,
                                std::span<const float> spacing, const Context& ctx) {
    const InitialTreeLinks links(tree);
    const auto members = group_by(samples.node, tree.size());
    std::vector<SegmentSums> of_segment(tree.size());
    parallel_for(ctx, tree.size(), 64, [&](std::size_t i) {
        const auto n = static_cast<std::uint32_t>(i);
        const std::uint32_t q = tree.parent[n];
        if (q == kNoIndex) return;  // the samples around a root do not form a tube
        const bool tapers = links.leader(q) == n;
        of_segment[n] = sum_segment(surface_cone(tree, links, n), tapers, members[n], samples, spacing);
    });
    std::vector<Sums> out(tree.size());
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        out[n] = of_segment[n].lower;
        if (links.leader(n) != kNoIndex) out[n].add(of_segment[links.leader(n)].upper);
    }
    return out;
}

/// Returns the sums of a node and its neighbours on the axis.
Sums sums_about(const InitialTree& tree, std::span<const std::uint32_t> next, std::span<const Sums> of_node,
                std::uint32_t n) {
    Sums out = of_node[n];
    std::uint32_t m = n;
    for (int k = 0; k < kWindow && next[m] != kNoIndex; ++k) out.add(of_node[m = next[m]]);
    m = n;
    for (int k = 0; k < kWindow && tree.parent[m] != kNoIndex && next[tree.parent[m]] == m; ++k)
        out.add(of_node[m = tree.parent[m]]);
    return out;
}

NodeEvidence compute_evidence(const Sums& own, const Sums& about, double radius) {
    if (!(about.weight > 0)) return {};
    const double mean = about.off / about.weight;
    const double free = std::max(about.weight - kFreedom, 0.0);
    const double squared = std::max(0.0, about.squared - about.off * mean);
    // Points of neighbours do not support a node without own points, for example one that bridges a gap.
    const double points = std::min(about.weight, kBorrowed * own.weight);
    return {own.weight, points, std::max(radius + mean, kMinRadius * radius),
            free > 0 ? std::sqrt(squared / free) : radius, about.spacing / about.weight};
}

}  // namespace

double NodeEvidence::filled() const {
    if (fixed) return 0;
    if (!(radius > 0)) return 1;
    const double few = kDiscScatter * radius, free = std::max(points - kFreedom, 0.0);
    const double variance = (free * scatter * scatter + kFewPoints * few * few) / (free + kFewPoints);
    const double ratio = variance / (kFilled * radius * kFilled * radius), cubed = ratio * ratio * ratio;
    return cubed / (1 + cubed);
}

double NodeEvidence::precision() const {
    if (fixed) return 1 / (kFixedError * kFixedError);
    const double free = points - kFreedom;
    if (!(radius > 0) || !(free > 0)) return 0;
    const double error =
        (scatter * scatter + kOfSpacing * spacing * kOfSpacing * spacing) / (radius * radius);
    return (1 - filled()) / (error / free + kMinError * kMinError);
}

std::vector<NodeEvidence> gather_evidence(const InitialTree& tree, const FitSamples& samples,
                                          std::span<const float> spacing, const Context& ctx) {
    const std::vector<Sums> of_node = sums_of_nodes(tree, samples, spacing, ctx);
    const std::vector<std::uint32_t> next = axis_children(tree);
    std::vector<NodeEvidence> out(tree.size());
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        out[n] = compute_evidence(of_node[n], sums_about(tree, next, of_node, n), tree.radius[n]);
        if (!tree.fixed[n]) continue;
        out[n].fixed = true;
        out[n].radius = tree.radius[n];
    }
    for (std::uint32_t n = 0; n < tree.size(); ++n)
        if (out[n].spacing == 0 && tree.parent[n] != kNoIndex) out[n].spacing = out[tree.parent[n]].spacing;
    return out;
}

}  // namespace coppice::extract_internal
