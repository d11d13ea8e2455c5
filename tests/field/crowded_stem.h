#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A stem of ten segments of length one tenth, with 99 twigs at each of the nine inner nodes, in depth-first
/// order. The last segment has nine ancestors and 99 siblings; 792 other twigs are nearer to it than its
/// first ancestor.
inline Skeleton crowded_stem() {
    std::vector<NodeId> parents{NodeId::none()};
    std::vector<Vec3> positions{{0, 0, 0}};
    std::uint32_t end = 0;
    const auto add = [&](Vec3 p) {
        parents.emplace_back(end);
        positions.push_back(p);
    };
    for (int k = 1; k <= 10; ++k) {
        const float z = 0.1f * static_cast<float>(k);
        for (int twig = 0; k > 1 && twig < 99; ++twig) add({0.1f, 0.001f * static_cast<float>(twig), z});
        add({0, 0, z});
        end = static_cast<std::uint32_t>(positions.size() - 1);
    }
    std::vector<float> radii(positions.size(), 0.05f);
    return {std::move(parents), std::move(positions), std::move(radii)};
}

}  // namespace coppice
