#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/id.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/cloud/initial_tree_internal.h"
#include "coppice/extract/cloud/tree_internal.h"
#include "coppice/extract/prior/evidence_internal.h"
#include "coppice/extract/stem/stem_axis_internal.h"
#include "coppice/spatial/overlap_queries.h"

namespace coppice::extract_internal {
namespace {

constexpr double kLook = 1;           // [spacing] distance from a surface up to which distances are computed
constexpr double kSigmas = 4;         // [noise] maximum distance of points on a surface
constexpr double kOnRadius = 0.2;     // [radius] maximum distance of points used to estimate the noise
constexpr double kThick = 1;          // [spacing] minimum radius of a segment used to estimate the noise
constexpr std::size_t kEnough = 100;  // minimum number of points to estimate the noise

constexpr double kSearchReach = 2;  // [spacing] maximum distance of a surface that may explain a point
// [spacing] minimum distance at which another surface does not explain a point
constexpr double kSecondSpacing = 0.5;
constexpr double kSecondRadius = 0.8;  // [radius of the other branch] the same limit
constexpr double kOwnRadius = 2;       // [radius of its own branch] maximum of that limit
constexpr double kMinGain = 1.5;       // minimum number of points that a branch must explain
constexpr double kMinShare = 0.45;     // minimum share of its points that a branch must explain
constexpr double kThin = 0.08;         // [spacing] minimum radius of a branch within reach of others
constexpr std::size_t kAssignmentGrain = 4096;

/// Spatial index of all segments of a tree.
class Cones {
  public:
    /// Boxes include the space up to `beyond` [radius] outside the surface.
    Cones(const InitialTree& tree, const InitialTreeLinks& links, double beyond, const Context& ctx)
        : cones_(compute_cones(tree, links)), boxes_(compute_boxes(cones_, beyond)), index_(boxes_, ctx) {}
    const RoundCone& operator[](std::uint32_t n) const { return cones_[n]; }
    /// Calls visit(i, segments) for every point with the segments that have a surface possibly within
    /// reach(i) [m] of it.
    template <class Reach, class Visit>
    void visit(std::span<const Vec3> points, const Reach& reach, const Context& ctx,
               const Visit& visit) const {
        parallel_for_ranges(ctx, points.size(), kAssignmentGrain, [&](IndexRange range) {
            OverlapQueries queries(index_, boxes_);
            const auto compute_box = [&](std::size_t i) {
                return Box3{points[i], points[i]}.inflated(static_cast<float>(reach(i)));
            };
            queries.visit(range, compute_box, visit);
        });
    }

  private:
    static std::vector<RoundCone> compute_cones(const InitialTree& tree, const InitialTreeLinks& links) {
        std::vector<RoundCone> cones;
        for (std::uint32_t n = 0; n < tree.size(); ++n) cones.push_back(surface_cone(tree, links, n));
        return cones;
    }
    static std::vector<Box3> compute_boxes(std::span<const RoundCone> cones, double beyond) {
        std::vector<Box3> boxes;
        for (const RoundCone& c : cones) {
            const auto r = static_cast<float>((1.0001 + beyond) * std::max(c.radius_a, c.radius_b()));
            boxes.push_back(capsule_box(Vec3(c.a), Vec3(c.b()), r));
        }
        return boxes;
    }
    std::vector<RoundCone> cones_;
    std::vector<Box3> boxes_;
    BoxTree index_;
};

/// Returns the standard deviation of the points about segments that are thick relative to their spacing.
double compute_noise(std::span<const float> distance, std::span<const float> radius,
                     std::span<const float> spacing) {
    std::vector<float> off;
    for (std::size_t i = 0; i < distance.size(); ++i) {
        if (radius[i] > kThick * spacing[i] && std::abs(distance[i]) < kOnRadius * radius[i])
            off.push_back(std::abs(distance[i]));
    }
    if (off.size() < kEnough) return 0;
    return 1.4826 * median_in_place(off);
}

/// Segment that explains a point, the next best one of another branch, and the gain of the first: from 0
/// to 1.
struct NearestBranches {
    std::uint32_t first = kNoIndex, second = kNoIndex;
    float gain = 0;
};

/// Selects from the segments near a point; `branch` is the branch of each, `margin` [m] the distance at which
/// its points may be by chance.
NearestBranches nearest_branches(const Cones& cones, std::span<const std::uint32_t> near,
                                 std::span<const std::uint32_t> branch, std::span<const double> margin,
                                 Vec3 point, double spacing) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const Vec3d p(point);
    double best = kInfinity, next = kInfinity, best_radius = 0, next_radius = 0;
    NearestBranches out;
    for (const std::uint32_t n : near) {
        const RoundCone::ClosestPoint closest = cones[n].closest_point(p);
        const double d = closest.signed_distance(), r = closest.radius;
        if (d < best) {
            if (out.first != kNoIndex && branch[out.first] != branch[n]) {
                next = best;
                next_radius = best_radius;
                out.second = out.first;
            }
            best = d;
            best_radius = r;
            out.first = n;
        } else if (d < next && branch[n] != branch[out.first]) {
            next = d;
            next_radius = r;
            out.second = n;
        }
    }
    if (out.first == kNoIndex) return out;
    if (out.second == kNoIndex) {
        out.gain = 1;
        return out;
    }
    const double slack = std::max({margin[out.second], kSecondSpacing * spacing,
                                   std::min(kSecondRadius * next_radius, kOwnRadius * best_radius)});
    const auto cost = [&](double d) { return std::min(1.0, d * d / (slack * slack)); };
    out.gain = static_cast<float>(cost(std::max(next, 0.0)) - cost(best));
    return out;
}

/// Returns the branch of every node: a sequence of segments between forks, identified by its last node.
std::vector<std::uint32_t> find_branches(const InitialTree& tree, const InitialTreeLinks& links) {
    std::vector<std::uint32_t> branch(tree.size());
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        const auto children = links.children(n);
        branch[n] = children.size() == 1 ? branch[children[0]] : n;
    }
    return branch;
}

/// Terminal branch and the number of points that require it.
struct Candidate {
    double gain;
    std::uint32_t tip;
};

/// Returns the terminal branches, the least required first.
std::vector<Candidate> find_candidates(const InitialTree& tree, const InitialTreeLinks& links,
                                       std::span<const NearestBranches> nearest,
                                       const CompressedRows<std::uint32_t>& members,
                                       std::span<const float> spacing) {
    std::vector<Candidate> order;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (!links.is_tip(n) || tree.parent[n] == kNoIndex) continue;
        Candidate c{0, n};
        bool near_others = true;
        double about = 0;
        for (const std::uint32_t i : members[n]) {
            c.gain += nearest[i].gain;
            about += spacing[i];
            near_others = near_others && nearest[i].second != kNoIndex;
        }
        // A branch without points has no gain.
        const auto points = static_cast<double>(std::max<std::size_t>(members[n].size(), 1));
        if (near_others && tree.radius[n] < kThin * about / points) c.gain = 0;
        order.push_back(c);
    }
    std::ranges::stable_sort(order, {}, &Candidate::gain);
    return order;
}

/// Returns the gain of a candidate after the removal of other branches.
double gain_now(const Candidate& c, std::span<const std::uint32_t> members,
                std::span<const NearestBranches> nearest, std::span<const char> gone) {
    double gain = 0;
    for (const std::uint32_t i : members) {
        if (c.gain > 0)
            gain += nearest[i].second != kNoIndex && gone[nearest[i].second] ? 1.0 : double{nearest[i].gain};
    }
    return gain;
}

}  // namespace

PointDistances assign_points(const InitialTree& tree, FitSamples& samples, std::span<const float> spacing,
                             const Context& ctx, const Tolerance& tolerance) {
    const std::size_t count = samples.positions.size();
    const InitialTreeLinks links(tree);
    const Cones cones(tree, links, tolerance.radii, ctx);
    PointDistances distances;
    const auto reach = [&](std::size_t i) {
        return std::max(tolerance.metres, tolerance.spacings * double{spacing[i]});
    };
    distances.distance.assign(count, std::numeric_limits<float>::infinity());
    Buffer<float> radius;
    radius.assign(count, 0);
    samples.node.assign(count, kNoIndex);
    // A thin branch may be closer than the thick one that a point is on.
    std::vector<std::uint32_t> on(count, kNoIndex);
    const auto look = [&](std::size_t i) { return std::max(reach(i), kLook * double{spacing[i]}); };
    cones.visit(samples.positions, look, ctx, [&](std::size_t i, std::span<const std::uint32_t> near_point) {
        double best = std::numeric_limits<double>::infinity(), least = 0;
        const Vec3d p(samples.positions[i]);
        for (const std::uint32_t n : near_point) {
            const RoundCone::ClosestPoint closest = cones[n].closest_point(p);
            const double d = closest.signed_distance();
            const double near = tree.fixed[n]
                                    ? reach_of_stem(closest.radius, double{spacing[i]}) - closest.radius
                                    : tolerance.radii * closest.radius;
            const double off = d - std::max(near, reach(i));
            if (off < least || (off == least && n < on[i])) {
                least = off;
                on[i] = n;
            }
            if (!(d < best || (d == best && n < samples.node[i]))) continue;
            best = d;
            radius[i] = static_cast<float>(closest.radius);
            samples.node[i] = n;
        }
        distances.distance[i] = static_cast<float>(best);
    });
    distances.noise = compute_noise(distances.distance, radius, spacing);
    parallel_for(ctx, count, kAssignmentGrain, [&](std::size_t i) {
        const double off =
            std::max({kSigmas * distances.noise, tolerance.radii * double{radius[i]}, reach(i)});
        if (!(distances.distance[i] <= off)) samples.node[i] = on[i];
    });
    return distances;
}

std::uint32_t prune_redundant(InitialTree& tree, FitSamples& samples, std::span<const float> spacing,
                              double noise, const Context& ctx) {
    const InitialTreeLinks links(tree);
    const Cones cones(tree, links, 0, ctx);
    const auto branch = find_branches(tree, links);
    std::vector<double> margin;
    for (const NodeEvidence& e : gather_evidence(tree, samples, spacing, ctx))
        margin.push_back(std::max(kSigmas * noise, e.margin()));
    std::vector<NearestBranches> nearest(samples.positions.size());
    std::vector<std::uint32_t> key(nearest.size(), kNoIndex);
    const auto reach = [&](std::size_t i) { return kSearchReach * double{spacing[i]}; };
    cones.visit(samples.positions, reach, ctx, [&](std::size_t i, std::span<const std::uint32_t> near) {
        nearest[i] = nearest_branches(cones, near, branch, margin, samples.positions[i], spacing[i]);
        if (nearest[i].first != kNoIndex) key[i] = branch[nearest[i].first];
    });
    const auto members = group_by(key, tree.size());
    std::vector<char> gone(tree.size(), 0);
    std::uint32_t count = 0;
    for (const Candidate& c : find_candidates(tree, links, nearest, members, spacing)) {
        const auto points = members[c.tip];
        if (gain_now(c, points, nearest, gone) >=
            std::max(kMinGain, kMinShare * static_cast<double>(points.size())))
            continue;
        for (std::uint32_t n = c.tip; tree.parent[n] != kNoIndex && branch[n] == c.tip; n = tree.parent[n])
            gone[n] = 1;
        for (const std::uint32_t i : points) nearest[i].first = nearest[i].second;
        ++count;
    }
    const auto new_of_old = sort_parents_first(tree, gone);
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        const std::uint32_t n = nearest[i].first;
        samples.node[i] = n != kNoIndex && samples.node[i] != kNoIndex && !gone[n] ? new_of_old[n] : kNoIndex;
    }
    return count;
}

}  // namespace coppice::extract_internal
