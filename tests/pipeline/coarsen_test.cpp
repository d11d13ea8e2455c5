#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "coppice/measure/intersections.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/coarsen/node_levels_internal.h"
#include "coppice/pipeline/live_surface.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/surface_verdict.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

namespace coppice {
namespace {

MeshOptions by_radius(int levels = 2) {
    MeshOptions options;
    options.levels = levels;
    options.tube_sides = TubeSides::by_radius;
    return options;
}

// Vertical, with radius 0.32 at the bottom and a 64th of it at the top.
Skeleton tapered_limb() {
    std::vector<NodeId> parent{NodeId::none()};
    std::vector<Vec3> position{{0, 0, 0}};
    std::vector<float> radius{0.32f};
    for (std::uint32_t i = 1; i <= 36; ++i) {
        parent.emplace_back(i - 1);
        position.push_back({0, 0, 0.2f * static_cast<float>(i)});
        radius.push_back(0.32f * std::exp2(-static_cast<float>(i) / 6));
    }
    return {parent, position, radius};
}

// Number of vertices of a surface by height.
std::map<float, int> sides_by_height(const QuadMesh& mesh) {
    std::map<float, int> out;
    for (const Vec3& p : mesh.positions) ++out[std::round(p.z * 1000) / 1000];
    return out;
}

std::size_t find_crossings(const QuadMesh& mesh) {
    return crossing_faces(SurfaceTree(to_polygons(mesh)), 1000).pairs.size();
}

TEST(RingsBetween, ChangeByOneLevelWithARefinedRingBetween) {
    for (int levels = 1; levels <= 6; ++levels) {
        for (int begin = 0; begin <= levels; ++begin) {
            for (int end = 0; end <= levels; ++end) {
                const int most = pipeline_internal::max_rows(begin, end, levels);
                for (int rows = std::min(begin, end); rows <= most; ++rows) {
                    SCOPED_TRACE(testing::Message() << levels << ' ' << begin << ' ' << end << ' ' << rows);
                    const auto rings = pipeline_internal::rings_between(begin, end, rows, levels);
                    EXPECT_EQ(rings.front().row, 0u);
                    EXPECT_EQ(rings.front().level, begin);
                    EXPECT_EQ(rings.back().row, 1u << levels);
                    EXPECT_EQ(rings.back().level, end);
                    if (begin == end) {
                        EXPECT_EQ(rings.size(), (1u << rows) + 1);
                    }
                    for (std::size_t i = 1; i < rings.size(); ++i) {
                        const int step = std::abs(rings[i].level - rings[i - 1].level);
                        EXPECT_LE(step, 1);
                        EXPECT_GE(rings[i].row, rings[i - 1].row + (step == 0 ? 1 : 2));
                    }
                }
            }
        }
    }
}

TEST(ChordError, MatchesTheLevelForIt) {
    for (int level = 0; level <= 5; ++level) {
        const float error = pipeline_internal::chord_error_at(0.4f, 4, level);
        EXPECT_EQ(pipeline_internal::level_for_chord(0.4f, 4, error), level);
        EXPECT_EQ(pipeline_internal::level_for_chord(0.4f / 16, 4, error), std::max(0, level - 2));
    }
    EXPECT_NEAR(pipeline_internal::chord_error_at(1, 4, 2), pipeline_internal::sagitta(16), 1e-3);
}

TEST(SidesByRadius, AreHalvedForEveryQuarterOfTheRadius) {
    const QuadMesh mesh = mesh_skeleton(tapered_limb(), by_radius()).quads().mesh;
    EXPECT_TRUE(topology(mesh).watertight());
    EXPECT_EQ(topology(mesh).euler, 2);
    EXPECT_EQ(find_crossings(mesh), 0u);
    const std::map<float, int> sides = sides_by_height(mesh);
    int sixteen = 0, eight = 0, four = 0;
    for (const auto& [z, count] : sides) {
        if (z < 1) {
            sixteen += count == 16 ? 1 : 0;
        } else if (z > 2.2f && z < 3.4f) {
            eight += count == 8 ? 1 : 0;
        } else if (z > 4.6f) {
            EXPECT_LE(count, 4);
            four += count == 4 ? 1 : 0;
        }
    }
    EXPECT_GT(sixteen, 2);
    EXPECT_GT(eight, 2);
    EXPECT_GT(four, 2);
}

TEST(SidesByRadius, PreserveVolumeAxesAndTips) {
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        SCOPED_TRACE(seed);
        const Skeleton tree = random_tree(400, seed);
        const MeshResult even = mesh_skeleton(tree), made = mesh_skeleton(tree, by_radius());
        const QuadMesh& mesh = made.quads().mesh;
        EXPECT_EQ(made.quads().coarsened->faces_before, even.quads().mesh.quads.size());
        EXPECT_LT(2 * mesh.quads.size(), even.quads().mesh.quads.size());
        EXPECT_TRUE(topology(mesh).watertight());
        EXPECT_EQ(topology(mesh).euler, topology(even.quads().mesh).euler);
        EXPECT_EQ(find_crossings(mesh), 0u);
        for (const Quad& q : mesh.quads) EXPECT_GT(scaled_jacobian(q, mesh.positions), 0);
        const auto before = judge_surface(even, tree, {}), after = judge_surface(made, tree, {});
        EXPECT_NEAR(after->volume->mesh, after->volume->cones, 0.01 * after->volume->cones);
        EXPECT_LE(after->axes.severed, before->axes.severed);
        EXPECT_LE(after->axes.short_tips, before->axes.short_tips);
    }
}

TEST(SidesByRadius, PreserveTheTopologyOfEverySkeleton) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const int levels : {1, 2}) {
            SCOPED_TRACE(name + " at level " + std::to_string(levels));
            MeshOptions even;
            even.levels = levels;
            const QuadSurface expected = mesh_skeleton(skeleton, even).quads();
            const QuadSurface made = mesh_skeleton(skeleton, by_radius(levels)).quads();
            EXPECT_TRUE(topology(made.mesh).watertight());
            EXPECT_EQ(topology(made.mesh).euler, topology(expected.mesh).euler);
            EXPECT_LE(made.mesh.quads.size(), expected.mesh.quads.size());
            if (expected.repair.pairs_after == 0) {
                EXPECT_EQ(find_crossings(made.mesh), 0u);
            }
        }
    }
}

TEST(SidesByRadius, SupportFlatEndsOpenBasesMoreSidesAndRamifications) {
    const Skeleton tree = random_tree(200, 5);
    MeshOptions flat = by_radius(), open = by_radius(), more = by_radius(), pasted = by_radius(3);
    flat.control.tips = TipShape::flat;
    open.control.base = BaseShape::open;
    more.control.sides = 8;
    pasted.method = MeshMethod::ramifications;
    for (const MeshOptions& options : {flat, open, more, pasted}) {
        MeshOptions even = options;
        even.tube_sides = TubeSides::equal;
        const QuadMesh expected = mesh_skeleton(tree, even).quads().mesh;
        const QuadMesh made = mesh_skeleton(tree, options).quads().mesh;
        EXPECT_LT(4 * made.quads.size(), 3 * expected.quads.size());
        EXPECT_EQ(topology(made).euler, topology(expected).euler);
        EXPECT_EQ(topology(made).non_manifold_edges, 0u);
        EXPECT_EQ(topology(made).open_edges > 0, topology(expected).open_edges > 0);
    }
}

TEST(SidesByRadius, IncreaseWithASmallerChordError) {
    const Skeleton tree = random_tree(200, 6);
    std::size_t last = 0;
    for (const float error : {0.02f, 0.01f, 0.005f, 0.002f}) {
        MeshOptions options = by_radius();
        options.chord_error = error;
        const std::size_t quads = mesh_skeleton(tree, options).quads().mesh.quads.size();
        EXPECT_GT(quads, last);
        last = quads;
    }
}

TEST(SidesByRadius, AreBitIdenticalForAnyNumberOfThreads) {
    const Skeleton tree = random_tree(300, 8, true);
    const QuadMesh one = mesh_skeleton(tree, by_radius(), {.threads = 1}).quads().mesh;
    const QuadMesh two = mesh_skeleton(tree, by_radius(), {.threads = 2}).quads().mesh;
    EXPECT_TRUE(std::ranges::equal(one.positions, two.positions));
    EXPECT_TRUE(std::ranges::equal(one.quads, two.quads));
}

TEST(SidesByRadius, AreRejectedForOtherSurfaces) {
    const Skeleton tree = random_tree(50, 1);
    MeshOptions tetrahedra = by_radius();
    tetrahedra.method = MeshMethod::tetrahedra;
    EXPECT_THROW(mesh_skeleton(tree, tetrahedra), InvalidInput);
    MeshOptions even;
    even.chord_error = 0.01f;
    EXPECT_THROW(mesh_skeleton(tree, even), InvalidInput);
    EXPECT_THROW(LiveSurface(tree, by_radius()), InvalidInput);
}

}  // namespace
}  // namespace coppice
