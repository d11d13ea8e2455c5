#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "coppice/base/random.h"
#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/mesh/topology.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/march/march.h"
#include "cuda/tetra_scene.h"
#include "tetra/surfaces.h"

namespace coppice {

inline void expect_same(const MarchResult& found, const MarchResult& expected) {
    EXPECT_EQ(found.report, expected.report);
    EXPECT_EQ(found.open, expected.open);
    EXPECT_EQ(found.mesh.triangles, expected.mesh.triangles);
    ASSERT_EQ(found.mesh.positions.size(), expected.mesh.positions.size());
    EXPECT_TRUE(found.mesh.positions == expected.mesh.positions) << "positions are not bit-identical";
}

/// Values that are constant in cells of a grid, and below the iso value near the hull of a box that starts at
/// 0.
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

/// Expects equal results, except for triangles where rounding affects whether a vertex is close enough to be
/// moved.
inline void expect_alike(const TetraScene& scene, const MarchResult& found, const MarchResult& expected,
                         std::size_t step) {
    EXPECT_EQ(found.open, expected.open);
    EXPECT_EQ(found.report.dropped, expected.report.dropped);
    const TopologyReport a = topology(polygons(found.mesh)), b = topology(polygons(expected.mesh));
    EXPECT_EQ(a.watertight(), b.watertight());
    EXPECT_EQ(a.euler, b.euler);
    EXPECT_EQ(a.components, b.components);
    const auto differ = [](std::uint64_t x, std::uint64_t y) { return x > y ? x - y : y - x; };
    EXPECT_LE(differ(found.report.snapped, expected.report.snapped), 1 + expected.report.snapped / 2000);
    EXPECT_LE(differ(found.report.inside, expected.report.inside), 1 + expected.report.inside / 2000);
    if (found.mesh.triangles != expected.mesh.triangles) return;
    // The gradient is discontinuous at a node of a cone, where rounding moves a few vertices along the
    // surface.
    std::size_t compared = 0, moved = 0;
    for (std::size_t v = 0; v < found.mesh.positions.size(); v += step, ++compared) {
        const Vec3 p = expected.mesh.positions[v];
        const float rounding = 4e-7f * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
        const float away = distance(found.mesh.positions[v], p), radius = scene.radius_near(p);
        moved += away > 1e-4f * radius + rounding ? 1 : 0;
        ASSERT_LE(away, 2e-3f * radius + rounding) << v;
    }
    EXPECT_LE(moved, 1 + compared / 100);
}

/// Truncates the end of the root, in every region.
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

/// A tree in tetrahedra, truncated at its root.
struct CutScene {
    CutScene(const Skeleton& tree, int levels, float edge)
        : tetra(tree, levels, edge),
          options{.levels = levels},
          ends(cut_at_root(tree, tetra.lattice.mesh().region_count())) {}
    const TetraMesh& mesh() const { return tetra.lattice.mesh(); }

    TetraScene tetra;
    MarchOptions options;
    EndCuts ends;
    CutConvolution field{tetra.field, ends};
    InsideAxes axes = tetra.inside();
};

}  // namespace coppice
