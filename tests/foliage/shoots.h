#pragma once

#include <cmath>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice::test {

/// A trunk with shoots around it, as a table of nodes.
struct ShootTree {
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    std::vector<StableId> ids;

    NodeId add(NodeId from, Vec3 at, float r) {
        parent.push_back(from);
        position.push_back(at);
        radius.push_back(r);
        ids.emplace_back(static_cast<std::uint32_t>(100 + ids.size()));
        return NodeId(static_cast<std::uint32_t>(parent.size() - 1));
    }
    /// Adds a straight shoot of nodes at distances of 5 cm.
    void add_shoot(NodeId from, Vec3 direction, float length, float r) {
        const Vec3 base = position[from.index()];
        const int count = static_cast<int>(std::lround(length / 0.05f));
        for (int k = 1; k <= count; ++k)
            from = add(from, base + direction * (0.05f * static_cast<float>(k)), r);
    }
    Skeleton make() const { return {parent, position, radius, {}, ids}; }
};

/// Returns a vertical trunk of radius 5 cm and height 1 m with shoots of 3 mm in many directions.
inline ShootTree make_shoot_tree(int shoots) {
    ShootTree tree;
    NodeId trunk = tree.add({}, {}, 0.05f);
    for (int i = 0; i < shoots; ++i) {
        const float t = (static_cast<float>(i) + 1) / static_cast<float>(shoots + 1);
        trunk = tree.add(trunk, {0, 0, t}, 0.05f);
        const float azimuth = 2.4f * static_cast<float>(i), rise = -0.5f + 1.4f * t;
        tree.add_shoot(trunk, normalized(Vec3{std::cos(azimuth), std::sin(azimuth), rise}), 0.6f, 0.003f);
    }
    tree.add(trunk, {0, 0, 1.2f}, 0.05f);
    return tree;
}

}  // namespace coppice::test
