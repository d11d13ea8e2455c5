#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Neither root nor tip nor branch node.
inline bool is_chain_node(const Skeleton& s, NodeId n) { return !s.is_root(n) && s.children(n).size() == 1; }

/// The angle between two ways, 0 where one has no direction.
inline double turn(Vec3d in, Vec3d out) { return std::atan2(length(cross(in, out)), dot(in, out)); }

/// Calls visit(anchor, chain) for every chain: the nodes from the first after a root or branch node to the
/// next branch node or tip, both included.
template <class Visit>
void for_each_chain(const Skeleton& s, const Visit& visit) {
    std::vector<NodeId> chain;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n) || is_chain_node(s, s.parent(n))) continue;
        chain.assign(1, n);
        while (is_chain_node(s, chain.back())) chain.push_back(s.children(chain.back()).front());
        visit(s.parent(n), std::as_const(chain));
    }
}

inline std::vector<NodeId> all_nodes(const Skeleton& s) {
    std::vector<NodeId> all;
    all.reserve(s.size());
    for (const NodeId n : nodes(s)) all.push_back(n);
    return all;
}

struct Subset {
    Skeleton skeleton;
    std::vector<NodeId> new_of_old;
};

/// The kept nodes with new positions and radii; roots must be kept. Where a node goes, its children join its
/// parent. It maps to its first child's image, or where it has none, to its parent's.
inline Subset take_nodes(const Skeleton& s, const std::vector<bool>& kept, std::span<const Vec3> position,
                         std::span<const float> radius) {
    std::vector<NodeId> parent, kept_ancestor(s.size()), image(s.size());
    std::vector<Vec3> p;
    std::vector<float> r;
    parent.reserve(s.size());
    p.reserve(s.size());
    r.reserve(s.size());
    for (const NodeId n : nodes(s)) {
        const NodeId from = s.is_root(n) ? NodeId::none() : kept_ancestor[s.parent(n).index()];
        kept_ancestor[n.index()] = from;
        if (!kept[n.index()]) continue;
        kept_ancestor[n.index()] = image[n.index()] = NodeId(static_cast<std::uint32_t>(parent.size()));
        parent.push_back(from);
        p.push_back(position[n.index()]);
        r.push_back(radius[n.index()]);
    }
    for (std::uint32_t i = s.size(); i-- > 0;) {
        if (image[i]) continue;
        const auto children = s.children(NodeId(i));
        image[i] = children.empty() ? kept_ancestor[i] : image[children.front().index()];
    }
    return {Skeleton(std::move(parent), std::move(p), std::move(r), s.origin()), std::move(image)};
}

}  // namespace coppice
