#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "coppice/base/random.h"
#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/march/march.h"
#include "tetra/surfaces.h"

namespace coppice {

inline void expect_same(const MarchResult& found, const MarchResult& expected) {
    EXPECT_EQ(found.report, expected.report);
    EXPECT_EQ(found.open, expected.open);
    EXPECT_EQ(found.mesh.triangles, expected.mesh.triangles);
    ASSERT_EQ(found.mesh.positions.size(), expected.mesh.positions.size());
    EXPECT_TRUE(found.mesh.positions == expected.mesh.positions) << "other bits";
}

/// Values constant in cells of a grid, and below the level near the hull of a box that begins at 0.
inline AnyField noise(std::uint64_t seed, float per_cell, Vec3 box) {
    return {[=](Vec3 p) {
                for (int axis = 0; axis < 3; ++axis) {
                    if (p[axis] < 1.01f || p[axis] > box[axis] - 1.01f) return -1.0f;
                }
                const auto q = [&](float x) { return static_cast<std::uint64_t>(x * per_cell); };
                const CounterRandom random(seed, 3);
                return static_cast<float>(random.uniform((q(p.x) * 4096 + q(p.y)) * 4096 + q(p.z), -1, 1));
            },
            0, 0.03f};
}

/// Cuts the root's end, in every region.
inline EndCuts cut_at_root(const Skeleton& skeleton, std::uint32_t regions) {
    EndCuts out;
    const NodeId root(0);
    if (skeleton.children(root).size() != 1) return out;
    const Vec3 way = skeleton.position(root) - skeleton.position(skeleton.children(root)[0]);
    if (length(way) == 0) return out;
    out.cuts.push_back({skeleton.position(root), normalized(way), skeleton.radius(root)});
    out.of_region = compress_rows<std::uint32_t>(regions, [&](const auto& put) {
        for (std::uint32_t r = 0; r < regions; ++r) put(r, 0u);
    });
    return out;
}

}  // namespace coppice
