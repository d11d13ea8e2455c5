#include "coppice/skeleton/measure.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace coppice {
namespace {

constexpr double kPi = std::numbers::pi;

double frustum_volume(double a, double b, double height) {
    return kPi / 3 * height * (a * a + a * b + b * b);
}

double frustum_mantle(double a, double b, double height) { return kPi * (a + b) * std::hypot(a - b, height); }

}  // namespace

SkeletonMeasures measure(const Skeleton& skeleton) {
    SkeletonMeasures m;
    m.nodes = skeleton.size();
    m.trees = skeleton.tree_count();
    m.segments = m.nodes - m.trees;
    m.bounds = skeleton.bounds();
    const auto [least, greatest] = std::ranges::minmax_element(skeleton.radii());
    m.least_radius = *least;
    m.greatest_radius = *greatest;
    std::vector<std::uint32_t> depth(m.nodes, 0);
    std::vector<double> path(m.nodes, 0.0);
    for (const NodeId n : nodes(skeleton)) {
        const auto children = static_cast<std::uint32_t>(skeleton.children(n).size());
        m.tips += children == 0;
        m.branch_nodes += children > 1;
        m.max_children = std::max(m.max_children, children);
        if (skeleton.is_root(n)) continue;
        const std::uint32_t p = skeleton.parent(n).index();
        const Segment s = skeleton.segment(n);
        const double l = distance(Vec3d(s.a), Vec3d(s.b));
        m.shortest_segment = m.length == 0 && m.longest_segment == 0 ? l : std::min(m.shortest_segment, l);
        m.longest_segment = std::max(m.longest_segment, l);
        m.length += l;
        m.volume += frustum_volume(s.radius_a, s.radius_b, l);
        m.area += frustum_mantle(s.radius_a, s.radius_b, l);
        depth[n.index()] = depth[p] + 1;
        path[n.index()] = path[p] + l;
        m.max_depth = std::max(m.max_depth, depth[n.index()]);
        m.longest_path = std::max(m.longest_path, path[n.index()]);
    }
    return m;
}

std::vector<BranchOrder> branch_orders(const Skeleton& s) {
    std::vector<std::uint32_t> order(s.size(), 0);
    std::vector<BranchOrder> out;
    for (const NodeId n : nodes(s)) {
        const bool begins = s.is_root(n) || s.leader(s.parent(n)) != n;
        if (!s.is_root(n)) order[n.index()] = order[s.parent(n).index()] + (begins ? 1 : 0);
        const std::uint32_t o = order[n.index()];
        if (o >= out.size()) out.resize(o + 1);
        out[o].branches += begins ? 1 : 0;
        if (!s.is_root(n)) out[o].length += distance(Vec3d(s.position(n)), Vec3d(s.position(s.parent(n))));
    }
    return out;
}

std::vector<NodeId> tree_roots(const Skeleton& skeleton) {
    std::vector<NodeId> root(skeleton.size());
    for (const NodeId n : nodes(skeleton)) {
        root[n.index()] = skeleton.is_root(n) ? n : root[skeleton.parent(n).index()];
    }
    return root;
}

}  // namespace coppice
