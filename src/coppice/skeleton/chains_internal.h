#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Returns whether a node is neither root nor tip nor branch node.
inline bool is_chain_node(const Skeleton& s, NodeId n) { return !s.is_root(n) && s.children(n).size() == 1; }

/// Returns the angle between two directions; 0 if one has zero length.
inline double turn(Vec3d in, Vec3d out) { return std::atan2(length(cross(in, out)), dot(in, out)); }

/// Calls visit(anchor, chain) for every chain: the nodes after a root or branch node up to and including the
/// next branch node or tip.
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

/// Returns the kept nodes with new positions and radii; roots must be kept. Children of a removed node are
/// attached to its closest kept ancestor. A removed node maps to the image of its first child or, if it has
/// no children, to that of its parent.
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
