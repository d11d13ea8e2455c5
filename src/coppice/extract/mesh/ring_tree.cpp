#include "coppice/extract/mesh/ring_tree_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/median.h"

namespace coppice::extract_internal {
namespace {

constexpr double kRound = 0.15;    // maximum spread of a ring that is considered circular
constexpr double kMinRound = 1.8;  // [median spread of the chain] the limit is at least this
constexpr double kReach = 3;   // [radius] maximum distance of the start of a chain from the ring of the fork
constexpr double kSame = 0.3;  // [radius] nodes closer than this are merged

/// Axis of one chain from its base outward.
struct Branch {
    std::vector<std::uint32_t> rings;  // kept rings, from the base outward; at least one
    std::uint32_t parent = kNoIndex;   // parent branch; kNoIndex for a branch that begins at a source
    double start = 0;                  // position of the start on the points of the parent: index + fraction
    std::vector<Vec3d> points;         // the first one is the start position if there is a parent
    std::vector<double> radii;

    std::uint32_t last() const { return static_cast<std::uint32_t>(points.size()) - 1; }
    Vec3d at(double t) const {
        const auto k = static_cast<std::uint32_t>(t);
        return lerp(points[k], points[std::min(k + 1, last())], t - k);
    }
    double radius_at(double t) const {
        const auto k = static_cast<std::uint32_t>(t);
        return radii[k] + (radii[std::min(k + 1, last())] - radii[k]) * (t - k);
    }
};

/// Branches of a ring forest, one per chain, and the positions of the rings on them.
struct Branches {
    std::vector<Branch> of_chain;
    std::vector<std::uint32_t> of_ring;  // branch of each ring
    std::vector<std::uint32_t> point;    // per ring: index of its point in the branch, or of the next point
                                         // outward if the ring was removed
};

/// Returns the circular rings of a chain, from the base outward; always includes the outermost ring.
std::vector<std::uint32_t> round_rings(const RingForest& forest, const RingChain& chain) {
    std::vector<double> spreads;
    for (std::uint32_t i = chain.first; i < chain.end; ++i) spreads.push_back(forest.rings[i].spread);
    const double limit = std::max(kRound, kMinRound * median_in_place(spreads));
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = chain.end; i-- > chain.first;) {
        if (forest.rings[i].spread <= limit || i == chain.first) kept.push_back(i);
    }
    return kept;
}

struct Window {  // range of the points of a parent
    std::uint32_t begin, end;
};

/// Returns the points of a parent within reach of the ring that the chain ran into, which is its point `at`.
Window window_about(const Branch& parent, const Ring& ring, std::uint32_t at) {
    Window w{std::min(at, parent.last()), 0};
    w.end = std::min(w.begin + 1, parent.last() + 1);
    const auto near = [&](std::uint32_t k) {
        return distance(parent.points[k], ring.center) < kReach * ring.radius;
    };
    while (w.begin > 0 && near(w.begin)) --w.begin;
    while (w.end < parent.points.size() && near(w.end)) ++w.end;
    return w;
}

/// Removes the rings of a lateral inside the surface of its parent: they are not cross-sections of the
/// lateral.
void drop_rings_inside(std::vector<std::uint32_t>& rings, const RingForest& forest, const Branch& parent,
                       Window w) {
    const auto inside = [&](Vec3d p) {
        for (std::uint32_t k = w.begin; k < w.end; ++k) {
            const std::uint32_t next = std::min(k + 1, parent.last());
            const RoundCone cone =
                round_cone(parent.points[k], parent.points[next], parent.radii[k], parent.radii[next]);
            if (cone.closest_point(p).signed_distance() < 0) return true;
        }
        return false;
    };
    std::size_t skip = 0;
    while (skip + 1 < rings.size() && inside(forest.rings[rings[skip]].center)) ++skip;
    rings.erase(rings.begin(), rings.begin() + static_cast<std::ptrdiff_t>(skip));
}

/// Returns where the axis through p, extended against `outward`, is closest to that of the parent: index +
/// fraction.
double attachment_point(Vec3d p, Vec3d outward, const Branch& parent, Window w) {
    constexpr int kSteps = 8;
    constexpr double kNearer = 0.8;  // prefers the closer of two points at equal distance from the line
    const Vec3d dir = normalized(p - outward, {});
    double best = std::numeric_limits<double>::infinity(), where = w.begin;
    for (std::uint32_t k = w.begin; k < w.end; ++k) {
        for (int i = 0; i < kSteps; ++i) {
            const double t = k + static_cast<double>(i) / kSteps;
            const Vec3d v = parent.at(t) - p;
            const double ahead = dot(v, dir);
            const double cost = length(v - dir * ahead) + kNearer * length(v) + std::max(0.0, -ahead);
            if (cost >= best) continue;
            best = cost;
            where = t;
        }
    }
    return std::min<double>(where, parent.last());
}

/// Attaches a lateral to the branch of ring `to`, which its chain ran into.
void attach(Branch& branch, const RingForest& forest, const Branches& branches, std::uint32_t to, Vec3d tip) {
    branch.parent = branches.of_ring[to];
    const Branch& parent = branches.of_chain[branch.parent];
    const Window w = window_about(parent, forest.rings[to], branches.point[to]);
    drop_rings_inside(branch.rings, forest, parent, w);
    const auto center = [&](std::size_t k) { return forest.rings[branch.rings[k]].center; };
    const Vec3d outward =
        branch.rings.size() > 1 ? center(std::min<std::size_t>(2, branch.rings.size() - 1)) : tip;
    branch.start = attachment_point(center(0), outward, parent, w);
    branch.points.push_back(parent.at(branch.start));
    branch.radii.push_back(parent.radius_at(branch.start));
}

/// Adds the branch of a chain; requires that of its parent.
void add_branch(Branches& branches, const Surface& surface, const RingForest& forest, std::uint32_t c) {
    const RingChain& chain = forest.chains[c];
    const Vec3d tip(surface.positions[chain.tip]);
    Branch branch{round_rings(forest, chain)};
    if (const std::uint32_t to = forest.rings[chain.end - 1].parent; to != kNoIndex)
        attach(branch, forest, branches, to, tip);
    auto next = static_cast<std::uint32_t>(branch.points.size());
    std::size_t kept = 0;
    for (std::uint32_t i = chain.end; i-- > chain.first;) {
        branches.of_ring[i] = c;
        branches.point[i] = next;
        if (kept == branch.rings.size() || branch.rings[kept] != i) continue;
        branch.points.push_back(forest.rings[i].center);
        branch.radii.push_back(forest.rings[i].radius);
        if (++kept < branch.rings.size()) ++next;
    }
    if (branch.points.size() == 1) {  // a single ring has no axis: use the direction to the tip
        branch.points.push_back(lerp(branch.points[0], tip, 0.5));
        branch.radii.push_back(branch.radii[0]);
    }
    branches.of_chain.push_back(std::move(branch));
}

/// Returns the laterals of every branch, sorted by their start.
std::vector<std::vector<std::uint32_t>> find_laterals(std::span<const Branch> branches) {
    std::vector<std::vector<std::uint32_t>> laterals(branches.size());
    for (std::uint32_t c = 0; c < branches.size(); ++c)
        if (branches[c].parent != kNoIndex) laterals[branches[c].parent].push_back(c);
    for (auto& list : laterals) {
        std::sort(list.begin(), list.end(), [&](std::uint32_t a, std::uint32_t b) {
            const double x = branches[a].start, y = branches[b].start;
            return x != y ? x < y : a < b;
        });
    }
    return laterals;
}

/// Adds the nodes of a branch, including those at the starts of laterals, which it stores in `first_node`.
/// Returns the node of every point.
std::vector<std::uint32_t> add_nodes(InitialTree& tree, std::span<Branch> branches, std::uint32_t c,
                                     std::span<const std::uint32_t> laterals,
                                     std::span<std::uint32_t> first_node) {
    const Branch& branch = branches[c];
    std::vector<std::uint32_t> node;
    std::uint32_t last = kNoIndex;
    std::size_t l = 0;
    for (std::uint32_t k = 0; k <= branch.last(); ++k) {
        last = k == 0 && first_node[c] != kNoIndex ? first_node[c]
                                                   : tree.add(last, branch.points[k], branch.radii[k]);
        node.push_back(last);
        for (; l < laterals.size() && (k == branch.last() || branches[laterals[l]].start < k + 1); ++l) {
            double& start = branches[laterals[l]].start;
            const double t = std::min<double>(start, branch.last());
            const double same = kSame * branch.radius_at(t);
            if (k < branch.last() && distance(branch.at(t), branch.points[k + 1]) < same) {
                start = k + 1;
                break;
            }
            if (distance(branch.at(t), tree.position[last]) >= same)
                last = tree.add(last, branch.at(t), branch.radius_at(t));
            first_node[laterals[l]] = last;
        }
    }
    return node;
}

}  // namespace

RingTree connect_rings(const Surface& surface, const RingForest& forest) {
    const std::size_t chains = forest.chains.size(), rings = forest.rings.size();
    Branches branches{{}, std::vector<std::uint32_t>(rings), std::vector<std::uint32_t>(rings)};
    for (std::uint32_t c = 0; c < chains; ++c) add_branch(branches, surface, forest, c);
    const auto laterals = find_laterals(branches.of_chain);
    RingTree out;
    std::vector<std::uint32_t> first_node(chains, kNoIndex);
    std::vector<std::vector<std::uint32_t>> node(chains);
    for (std::uint32_t c = 0; c < chains; ++c)
        node[c] = add_nodes(out.tree, branches.of_chain, c, laterals[c], first_node);
    for (std::size_t r = 0; r < rings; ++r)
        out.node_of_ring.push_back(node[branches.of_ring[r]][branches.point[r]]);
    for (const RingChain& chain : forest.chains)
        if (chain.touched != kNoIndex)
            out.loops.push_back({out.node_of_ring[chain.first], out.node_of_ring[chain.touched]});
    return out;
}

}  // namespace coppice::extract_internal
