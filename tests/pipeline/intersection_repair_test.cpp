#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "coppice/base/random.h"
#include "coppice/measure/surface_report.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/live_surface.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/surface_verdict.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

// Remeshing of quads that would cross.

namespace coppice {
namespace {

MeshOptions with(Overlaps overlaps) {
    MeshOptions options;
    options.overlaps = overlaps;
    return options;
}

std::uint64_t crossings(const QuadMesh& mesh) {
    return check_surface(to_polygons(mesh), nullptr).intersections->total;
}

// A ball at the end of a thread.
Skeleton fat_end() {
    return Skeleton({NodeId::none(), NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 8}, {0, 0, 9}},
                    {0.5f, 0.5f, 13});
}

// Adjacent balls, and threads that leave the first of them.
Skeleton balls_with_threads() {
    const NodeId a(0);
    return Skeleton({NodeId::none(), a, a, a, NodeId(3), a, NodeId(5), a, NodeId(7)},
                    {{0, 0, 0},
                     {2, 1, 0},
                     {-3, 1, 1},
                     {-4, 4.4f, -2.7f},
                     {-16, 20, -14.5f},
                     {1.1f, -0.6f, 3.5f},
                     {7.6f, -8.3f, 41},
                     {0, 4, -4.4f},
                     {0.3f, 16, -20}},
                    {5, 4, 3, 0.7f, 0.5f, 0.4f, 0.3f, 0.8f, 0.6f});
}

// A branch in a loop through its own beginning.
Skeleton noose() {
    std::vector<NodeId> parent{NodeId::none(), NodeId(0)};
    std::vector<Vec3> position{{0, 0, -3}, {0, 0, 0}};
    constexpr int kSteps = 24;
    for (int k = 1; k <= kSteps; ++k) {
        const float a = 2 * std::numbers::pi_v<float> * static_cast<float>(k) / kSteps;
        parent.emplace_back(static_cast<std::uint32_t>(parent.size() - 1));
        position.push_back({2 - 2 * std::cos(a), 0, 2 * std::sin(a) - 1.5f * static_cast<float>(k) / kSteps});
    }
    parent.emplace_back(static_cast<std::uint32_t>(parent.size() - 1));
    position.push_back({-3, 0, -1.5f});
    const std::size_t n = parent.size();
    return Skeleton(std::move(parent), std::move(position), std::vector<float>(n, 0.3f));
}

// Two separate bars that cross at a right angle.
Skeleton crossed_bars() {
    return Skeleton({NodeId::none(), NodeId(0), NodeId::none(), NodeId(2)},
                    {{-3, 0, 0}, {3, 0, 0}, {0, -3, 0.1f}, {0, 3, 0.1f}}, {0.5f, 0.5f, 0.4f, 0.4f});
}

TEST(RemovedRows, CleanTreeIsBitIdenticalWithoutRepair) {
    MeshOptions off;
    off.remesh_rounds = 0;
    const Skeleton tree = random_tree(300, 2);
    const QuadSurface with_net = mesh_skeleton(tree).quads(), without = mesh_skeleton(tree, off).quads();
    EXPECT_EQ(with_net.repair.rounds, 0u);
    EXPECT_EQ(with_net.mesh.quads, without.mesh.quads);
    ASSERT_EQ(with_net.mesh.positions.size(), without.mesh.positions.size());
    EXPECT_EQ(std::memcmp(with_net.mesh.positions.data(), without.mesh.positions.data(),
                          without.mesh.positions.size() * sizeof(Vec3)),
              0);
}

TEST(RemovedRows, ResultHasNoSelfIntersectionsOnTheZoo) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const QuadSurface made = mesh_skeleton(skeleton).quads();
        EXPECT_EQ(crossings(made.mesh), 0u);
        EXPECT_EQ(made.repair.pairs_after, 0u);
        const TopologyReport t = topology(made.mesh);
        EXPECT_TRUE(t.watertight());
        EXPECT_EQ(t.quads, t.faces);
        EXPECT_EQ(shape(made.mesh).inverted_faces, 0u);
        if (made.repair.rounds == 0) continue;
        EXPECT_EQ(t.components, made.repair.parts);
        EXPECT_EQ(t.euler, 2 * (static_cast<std::int64_t>(t.components) - made.repair.handles));
    }
}

TEST(RemovedRows, ResultHasNoSelfIntersectionsForAnyLevelAndNumberOfSides) {
    const Skeleton hard = zoo_skeleton("random_hard_2");
    for (const int levels : {1, 2, 3}) {
        for (const int sides : {4, 8}) {
            SCOPED_TRACE(std::to_string(levels) + " levels, " + std::to_string(sides) + " sides");
            MeshOptions options;
            options.levels = levels;
            options.control.sides = sides;
            const QuadSurface made = mesh_skeleton(hard, options).quads();
            EXPECT_EQ(crossings(made.mesh), 0u);
            EXPECT_TRUE(topology(made.mesh).watertight());
        }
    }
}

// If there are too few rounds, crossings may remain, but no part is lost.
TEST(RemovedRows, FewRoundsPreserveTheWholeSurface) {
    const Skeleton tree = random_tree(300, 1, true);
    const std::size_t whole = mesh_skeleton(tree, with(Overlaps::keep)).quads().mesh.quads.size();
    for (const int rounds : {1, 2, 3}) {
        SCOPED_TRACE(rounds);
        MeshOptions options;
        options.remesh_rounds = rounds;
        const QuadSurface surface = mesh_skeleton(tree, options).quads();
        EXPECT_GT(surface.repair.pairs_before, 0u);
        EXPECT_TRUE(topology(surface.mesh).watertight());
        EXPECT_GT(surface.mesh.quads.size(), whole / 2);
    }
}

TEST(RemovedRows, SomaOfThreePointsPreservesItsVolume) {
    const QuadSurface made = mesh_skeleton(zoo_skeleton("soma_of_three_points")).quads();
    EXPECT_GT(made.repair.tube_rows, 0u);
    EXPECT_EQ(crossings(made.mesh), 0u);
    constexpr double kCapsule = std::numbers::pi * 25 * (10 + 20.0 / 3);
    EXPECT_NEAR(shape(made.mesh).signed_volume / kCapsule, 1.02, 0.03);  // and 97 of neurites
}

// A stem with two adjacent forks: `reach` is the lean of the thin branches, `gap` the distance between them.
Skeleton two_forks(float reach, float radius, float gap) {
    const NodeId b(1), c(2);
    return Skeleton({NodeId::none(), NodeId(0), b, b, c, c},
                    {{0, 0, 0},
                     {0, 0, 2},
                     {0, 0, 2 + gap},
                     {2 * reach, 0.1f, 4},
                     {-0.2f * reach, 3 * reach, 5},
                     {0.1f, -3 * reach, 5}},
                    {0.3f, 0.3f, 0.25f, radius, radius, 0.2f});
}

TEST(RemovedRows, SeveredBranchesAreRemeshed) {
    const auto severed = [](const Skeleton& skeleton, int rounds) {
        MeshOptions options;
        options.remesh_rounds = rounds;
        return judge_surface(mesh_skeleton(skeleton, options), skeleton, {})->axes.severed;
    };
    std::uint64_t before = 0;
    for (const float reach : {0.1f, 0.3f, 0.5f}) {
        for (const float radius : {0.05f, 0.1f, 0.2f}) {
            for (const float gap : {0.3f, 0.7f}) {
                const Skeleton forks = two_forks(reach, radius, gap);
                before += severed(forks, 0);
                const QuadSurface made = mesh_skeleton(forks).quads();
                EXPECT_EQ(severed(forks, MeshOptions{}.remesh_rounds), 0u);
                EXPECT_EQ(crossings(made.mesh), 0u);
                EXPECT_TRUE(topology(made.mesh).watertight());
            }
        }
    }
    EXPECT_GT(before, 3u);
}

TEST(RemovedRows, SeveredRowsAreCounted) {
    const Skeleton forks = two_forks(0.5f, 0.05f, 0.3f);
    EXPECT_GT(mesh_skeleton(forks).quads().repair.severed, 0u);
    EXPECT_EQ(mesh_skeleton(random_tree(300, 2)).quads().repair.severed, 0u);
}

TEST(RemovedRows, SingleNodeThatIntersectsABranchIsReplaced) {
    const NodeId none;
    const Skeleton s({none, none, NodeId(1), NodeId(2)}, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0.4f}, {0, 0, 2}},
                     {0.2f, 0.2f, 0.2f, 0.2f});
    const QuadSurface made = mesh_skeleton(s).quads();
    EXPECT_GT(made.repair.tube_rows, 0u);
    EXPECT_EQ(crossings(made.mesh), 0u);
}

TEST(RemovedRows, PreserveThickPartsNextToThinThreads) {
    for (const Skeleton& s : {fat_end(), balls_with_threads()}) {
        const QuadSurface made = mesh_skeleton(s).quads();
        EXPECT_GT(made.repair.lost_bulges, 0u);
        EXPECT_EQ(crossings(made.mesh), 0u);
        MeshOptions fine;
        fine.method = MeshMethod::tetrahedra;
        fine.tetra.edge = 0.25f;
        const double whole = shape(to_polygons(mesh_skeleton(s, fine).tetrahedra().mesh)).signed_volume;
        EXPECT_NEAR(shape(made.mesh).signed_volume / whole, 1, 0.05);
    }
}

TEST(RemovedRows, MergedLoopIsAHandle) {
    const Skeleton loop = noose();
    const QuadSurface merged = mesh_skeleton(loop, with(Overlaps::merge)).quads();
    EXPECT_EQ(crossings(merged.mesh), 0u);
    EXPECT_EQ(merged.repair.parts, 1u);
    EXPECT_EQ(merged.repair.handles, 1);
    EXPECT_EQ(topology(merged.mesh).euler, 0);
    const QuadSurface kept = mesh_skeleton(loop, with(Overlaps::keep)).quads();
    EXPECT_GT(crossings(kept.mesh), 0u);
    EXPECT_EQ(topology(kept.mesh).euler, 2);
}

// Two limbs of one tree that cross, thick or thin, steep or slanting: no quads remain to be remeshed.
TEST(RemovedRows, IntersectingLimbsMergeWithoutRemeshing) {
    for (const float thin : {1.0f, 0.7f, 0.4f}) {
        for (const float slant : {0.0f, 0.5f, 0.9f}) {
            SCOPED_TRACE(thin);
            SCOPED_TRACE(slant);
            const float r = 0.1f * thin;
            const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3)},
                             {{0, 0, 0}, {0, 0, 1}, {0, 0, 5}, {-1.5f, 0, 2}, {1.5f, 0.02f, 3 + 2 * slant}},
                             {0.1f, 0.1f, 0.1f, r, r});
            const QuadSurface made = mesh_skeleton(s).quads();
            EXPECT_EQ(made.repair.pairs_before, 0u);
            EXPECT_EQ(made.repair.parts, 1u);
            EXPECT_EQ(made.repair.handles, 1);
            EXPECT_EQ(made.grafted.merged, 1u);
            EXPECT_EQ(crossings(made.mesh), 0u);
            EXPECT_EQ(topology(made.mesh).euler, 0);
            EXPECT_TRUE(topology(made.mesh).watertight());
        }
    }
}

// Stems within each other, of all radii.
Skeleton crowd(std::uint64_t seed) {
    const CounterRandom random(seed, 0);
    std::uint64_t draw = 0;
    const auto uniform = [&](double low, double high) {
        return static_cast<float>(random.uniform(draw++, low, high));
    };
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    for (std::uint32_t i = 0; i < 40; ++i) {
        const bool is_root = i == 0 || uniform(0, 1) < 0.07f;
        const auto before =
            static_cast<std::uint32_t>(uniform(0, 1) < 0.7f ? i - 1.0f : uniform(0, 0.99 * i));
        parent.push_back(is_root ? NodeId::none() : NodeId(before));
        position.push_back({uniform(-0.03, 0.03), uniform(-0.03, 0.03), 0.08f * static_cast<float>(i)});
        radius.push_back(uniform(0, 1) < 0.7f ? 0.1f : std::pow(10.0f, uniform(-3, -0.5)));
    }
    return {parent, position, radius};
}

TEST(RemovedRows, MergingIsNeverWorseThanGrafting) {
    std::size_t times_grafted = 0;
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u}) {
        SCOPED_TRACE(seed);
        const Skeleton s = crowd(seed);
        const QuadSurface merged = mesh_skeleton(s).quads();
        const QuadSurface grafted = mesh_skeleton(s, with(Overlaps::graft)).quads();
        EXPECT_LE(merged.repair.pairs_after, grafted.repair.pairs_after);
        EXPECT_TRUE(topology(merged.mesh).watertight());
        EXPECT_EQ(topology(merged.mesh).euler,
                  2 * (static_cast<std::int64_t>(merged.repair.parts) - merged.repair.handles));
        const QuadMesh live = LiveSurface(s, {}).mesh();
        EXPECT_EQ(live.quads.size(), merged.mesh.quads.size());
        EXPECT_TRUE(topology(live).watertight());
        times_grafted += merged.cage.joins.empty() ? 1 : 0;
    }
    EXPECT_GT(times_grafted, 0u);
    EXPECT_LT(times_grafted, 8u);
}

TEST(RemovedRows, IntersectingTreesAreGraftedBentApartOrMerged) {
    const Skeleton bars = crossed_bars();
    for (const Overlaps overlaps : {Overlaps::graft, Overlaps::apart, Overlaps::merge}) {
        const MeshResult made = mesh_skeleton(bars, with(overlaps));
        EXPECT_EQ(crossings(made.quads().mesh), 0u);
        EXPECT_EQ(topology(made.quads().mesh).components, overlaps == Overlaps::merge ? 1u : 2u);
        EXPECT_EQ(made.quads().repair.handles, 0);
        EXPECT_EQ(made.quads().grafted.grafted, overlaps == Overlaps::apart ? 0u : 1u);
        EXPECT_EQ(made.quads().grafted.merged, overlaps == Overlaps::merge ? 1u : 0u);
        EXPECT_EQ(made.bent_apart.has_value(), overlaps == Overlaps::apart);
    }
    EXPECT_EQ(topology(mesh_skeleton(bars, with(Overlaps::keep)).quads().mesh).components, 2u);
}

TEST(RemovedRows, TipsOfRemeshedBranchesEndOneRadiusBeyondTheirNodes) {
    std::uint64_t tips = 0, short_tips = 0;
    for (const std::uint64_t seed : {5, 6, 7}) {
        const Skeleton hard = random_tree(300, seed, true);
        const QuadSurface made = mesh_skeleton(hard).quads();
        EXPECT_GT(made.repair.tube_rows, 300u);
        const SurfaceReport report = check_surface(to_polygons(made.mesh), &hard);
        EXPECT_NEAR(report.axes->tip_reach.p50, 1, 0.002);
        tips += report.axes->tips;
        short_tips += report.axes->short_tips;
    }
    EXPECT_LT(20 * short_tips, tips);
}

// A twig that continues its stem, and a sibling that bends into the same direction: one tube contains both.
TEST(RemovedRows, TipsInTheTubeOfASiblingAreReached) {
    for (const auto& [way, angle] : {std::pair{0.36f, 0.6f}, {0.39f, 0.56f}, {0.42f, 0.6f}}) {
        SCOPED_TRACE(way);
        const Vec3 up{0, 0, 1}, fork = 0.6f * up;
        const Vec3 sibling = fork + way * Vec3{std::sin(angle), 0, std::cos(angle)};
        const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3)},
                         {{}, fork, fork + way * up, sibling, sibling + 0.48f * up},
                         {0.17f, 0.14f, 0.1f, 0.1f, 0.1f});
        const QuadSurface made = mesh_skeleton(s).quads();
        EXPECT_EQ(check_surface(to_polygons(made.mesh), &s).axes->short_tips, 0u);
        EXPECT_TRUE(topology(made.mesh).watertight());
        EXPECT_EQ(crossings(made.mesh), 0u);
    }
}

TEST(RemovedRows, AreBitIdenticalForAnyNumberOfThreads) {
    const Skeleton hard = random_tree(300, 5, true);
    const QuadMesh one = mesh_skeleton(hard, {}, {.threads = 1}).quads().mesh;
    const QuadMesh many = mesh_skeleton(hard, {}, {.threads = 7}).quads().mesh;
    EXPECT_EQ(one.quads, many.quads);
    ASSERT_EQ(one.positions.size(), many.positions.size());
    EXPECT_EQ(std::memcmp(one.positions.data(), many.positions.data(), one.positions.size() * sizeof(Vec3)),
              0);
}

}  // namespace
}  // namespace coppice
