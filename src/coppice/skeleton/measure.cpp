#include "coppice/skeleton/measure.h"

#include <algorithm>
#include <vector>

#include "coppice/skeleton/frustum.h"

namespace coppice {

SkeletonMeasures measure(const Skeleton& skeleton) {
    SkeletonMeasures m;
    m.nodes = skeleton.size();
    m.trees = skeleton.tree_count();
    m.segments = m.nodes - m.trees;
    m.bounds = skeleton.bounds();
    const auto [least, largest] = std::ranges::minmax_element(skeleton.radii());
    m.min_radius = *least;
    m.max_radius = *largest;
    std::vector<std::uint32_t> depth(m.nodes, 0);
    std::vector<double> path(m.nodes, 0.0);
    for (const NodeId n : nodes(skeleton)) {
        const auto children = static_cast<std::uint32_t>(skeleton.children(n).size());
        m.tips += children == 0;
        m.branch_nodes += children > 1;
        m.max_children = std::max(m.max_children, children);
        if (skeleton.is_root(n)) continue;
        const std::uint32_t p = skeleton.parent(n).index();
        const Frustum cone = frustum(skeleton.segment(n));
        const double l = cone.length;
        m.shortest_segment = m.length == 0 && m.longest_segment == 0 ? l : std::min(m.shortest_segment, l);
        m.longest_segment = std::max(m.longest_segment, l);
        m.length += l;
        m.volume += cone.volume();
        m.area += cone.mantle();
        const Frustum between{skeleton.radius(skeleton.parent(n)), skeleton.radius(n), l};
        m.volume_frusta += between.volume();
        m.area_frusta += between.mantle();
        depth[n.index()] = depth[p] + 1;
        path[n.index()] = path[p] + l;
        m.max_depth = std::max(m.max_depth, depth[n.index()]);
        m.longest_path = std::max(m.longest_path, path[n.index()]);
    }
    return m;
}

std::vector<NodeId> tree_roots(const Skeleton& skeleton) {
    std::vector<NodeId> root(skeleton.size());
    for (const NodeId n : nodes(skeleton)) {
        root[n.index()] = skeleton.is_root(n) ? n : root[skeleton.parent(n).index()];
    }
    return root;
}

}  // namespace coppice
