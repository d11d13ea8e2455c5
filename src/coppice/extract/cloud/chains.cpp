#include <algorithm>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/parallel.h"
#include "coppice/extract/cloud/centerline_internal.h"
#include "coppice/extract/cloud/initial_tree_internal.h"
#include "coppice/extract/prior/evidence_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kMin = 3;      // minimum number of points of a branch
constexpr double kHigh = 0.5;        // [radius of the parent] sufficient height of a tip above its bark
constexpr double kHighSpacings = 4;  // [spacing] sufficient height as well
// [length] sufficient height as well, because bark does not rise this steeply
constexpr double kSteep = 0.85;

/// Returns the height of a point above the existing surface: above all segments in `distances` and the few
/// segments towards the root from the end of its path.
double compute_rise(const InitialTree& tree, const PointDistances& distances, std::uint32_t point, Vec3d p,
                    std::uint32_t owner) {
    constexpr int kSegments = 3;
    double rise = distances.distance[point];
    std::uint32_t n = owner;
    for (int k = 0; n != kNoIndex && k < kSegments; n = tree.parent[n], ++k) {
        const RoundCone cone = axis_cone(tree, n);
        rise = std::min(rise, cone.closest_point(p).distance() - std::min(cone.radius_a, cone.radius_b()));
    }
    return rise;
}

std::vector<std::uint32_t> points_with_nodes(const FitSamples& samples) {
    std::vector<std::uint32_t> out;
    for (std::uint32_t p = 0; p < samples.node.size(); ++p)
        if (samples.node[p] != kNoIndex) out.push_back(p);
    return out;
}

/// Returns the minimum height [m] of a tip above its parent branch.
double min_rise(const Centerline& branch, const InitialTreeOptions& options, double radius, double margin) {
    const double above_bark =
        std::min({kHigh * radius, kHighSpacings * branch.spacing, kSteep * line_length(branch)});
    return std::max({options.reach * branch.spacing, above_bark, margin});
}

/// Returns the distance [m] from a new branch at which its points may be by chance.
double margin_of_branch(const Centerline& branch) {
    const auto count = static_cast<double>(branch.members.size());
    double squared = 0;
    for (const BranchPoint& m : branch.members) squared += m.squared / count;
    return compute_margin(count, std::sqrt(std::max(0.0, squared - branch.radius * branch.radius)));
}

/// Marks the points about a narrow branch that need no branch of their own.
void mark_covered(const Centerline& branch, BranchPoints& points, const CloudInput& cloud,
                  std::vector<std::uint8_t>& dead) {
    const double own = cloud.options.cover * branch.spacing;
    const double reach = cloud.leaf.empty() ? own : std::max(own, cloud.options.detail);
    for (const BranchPoint& p : points_about(branch, points, reach)) dead[p.point] = 1;
}

}  // namespace

void grow_chains(InitialTree& tree, FitSamples& samples, const CloudInput& cloud,
                 const PointDistances& distances, const Context& ctx) {
    Paths paths;
    std::vector<double> margin;
    parallel_for(ctx, 2, 1, [&](std::size_t part) {
        if (part == 0) {
            paths = shortest_paths(cloud.graph, points_with_nodes(samples), samples.node,
                                   cloud.cost(samples.positions), ctx);
        } else {
            for (const NodeEvidence& e : gather_evidence(tree, samples, cloud.spacing, ctx))
                margin.push_back(e.margin());
        }
    });
    BranchPoints points{samples.positions, cloud.graph,        cloud.spacing,
                        samples.node,      cloud.options.step, cloud.options.narrow};
    Centerline branch;
    std::vector<std::uint8_t> dead(samples.node.size(), 0);  // whether branches may not start at a point
    for (std::size_t i = paths.order.size(); i-- > 0;) {
        const std::uint32_t tip = paths.order[i];
        if (dead[tip] || samples.node[tip] != kNoIndex) continue;
        ctx.throw_if_cancelled();
        const std::uint32_t owner = samples.node[trace_path(branch, points, tip, paths)];
        const double least = min_rise(branch, cloud.options, tree.radius[owner], margin[owner]);
        bool good = compute_rise(tree, distances, tip, Vec3d(samples.positions[tip]), owner) >= least;
        if (good) {
            fit_centerline(branch, points, tree.radius[owner]);
            good = branch.members.size() >= kMin;
        }
        if (good) {
            if (cloud.options.narrow) mark_covered(branch, points, cloud, dead);
            add_branch(branch, tree, samples.node, owner);
            margin.resize(tree.size(), cloud.options.narrow ? 0 : margin_of_branch(branch));
        } else {
            for (const std::uint32_t p : branch.path) dead[p] = 1;
        }
    }
}

}  // namespace coppice::extract_internal
