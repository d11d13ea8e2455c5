#include "coppice/extract/tree/initial_tree_internal.h"

#include <utility>

#include "coppice/base/id.h"

namespace coppice {

InitialTreeLinks::InitialTreeLinks(const InitialTree& t)
    : children_(group_by(t.parent, t.size())), leader_(t.size()) {
    update_leaders(t);
}

void InitialTreeLinks::update_leaders(const InitialTree& t) {
    for (std::uint32_t n = 0; n < t.size(); ++n) {
        leader_[n] = kNoIndex;
        for (const std::uint32_t c : children(n))
            if (leader_[n] == kNoIndex || t.radius[c] > t.radius[leader_[n]]) leader_[n] = c;
    }
}

RoundCone axis_cone(const InitialTree& t, std::uint32_t n) {
    const std::uint32_t q = t.parent[n] == kNoIndex ? n : t.parent[n];
    return round_cone(t.position[q], t.position[n], t.radius[q], t.radius[n]);
}

RoundCone surface_cone(const InitialTree& t, const InitialTreeLinks& links, std::uint32_t n) {
    const std::uint32_t q = t.parent[n];
    const double r = t.radius[n];
    if (q == kNoIndex) return round_cone(t.position[n], t.position[n], r, r);
    return round_cone(t.position[q], t.position[n], links.leader(q) == n ? t.radius[q] : r, r);
}

void reroot(InitialTree& tree, std::uint32_t end) {
    std::uint32_t parent = kNoIndex;
    for (std::uint32_t n = end; n != kNoIndex;) {
        const std::uint32_t next = std::exchange(tree.parent[n], parent);
        parent = std::exchange(n, next);
    }
}

std::vector<std::uint32_t> sort_parents_first(InitialTree& tree, std::span<const char> gone) {
    const InitialTreeLinks links(tree);
    const auto stays = [&](std::uint32_t n) { return gone.empty() || !gone[n]; };
    std::vector<std::uint32_t> new_of_old(tree.size(), kNoIndex), stack;
    InitialTree sorted;
    for (std::uint32_t root = 0; root < tree.size(); ++root) {
        if (tree.parent[root] != kNoIndex || !stays(root)) continue;
        stack.push_back(root);
        while (!stack.empty()) {
            const std::uint32_t n = stack.back();
            stack.pop_back();
            const std::uint32_t q = tree.parent[n];
            new_of_old[n] = sorted.add(q == kNoIndex ? q : new_of_old[q], tree.position[n], tree.radius[n],
                                       tree.fixed[n]);
            const auto children = links.children(n);
            for (std::size_t i = children.size(); i-- > 0;)
                if (stays(children[i])) stack.push_back(children[i]);
        }
    }
    tree = std::move(sorted);
    return new_of_old;
}

Skeleton to_skeleton(const InitialTree& tree, Vec3d origin) {
    std::vector<NodeId> parent(tree.size());
    std::vector<Vec3> position(tree.size());
    std::vector<float> radius(tree.size());
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (tree.parent[n] != kNoIndex) parent[n] = NodeId(tree.parent[n]);
        position[n] = Vec3(tree.position[n]);
        radius[n] = static_cast<float>(tree.radius[n]);
    }
    return Skeleton(std::move(parent), std::move(position), std::move(radius), origin);
}

InitialTree to_initial_tree(const Skeleton& skeleton) {
    InitialTree tree;
    for (const NodeId n : nodes(skeleton)) {
        tree.add(skeleton.is_root(n) ? kNoIndex : skeleton.parent(n).index(), Vec3d(skeleton.position(n)),
                 static_cast<double>(skeleton.radius(n)));
    }
    return tree;
}

}  // namespace coppice
