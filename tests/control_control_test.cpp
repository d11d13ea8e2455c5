#include "coppice/control/control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "coppice/control/part.h"
#include "coppice/mesh/topology.h"
#include "zoo.h"

namespace coppice {
namespace {

std::vector<NodeId> same_nodes(const Skeleton& s) {
    std::vector<NodeId> ids;
    for (const NodeId n : nodes(s)) ids.push_back(n);
    return ids;
}

ControlMesh cage_of(const Skeleton& s, const ControlOptions& options = {}, unsigned threads = 2) {
    Context ctx;
    ctx.threads = threads;
    return build_control_mesh(s, same_nodes(s), options, ctx);
}

void expect_spheres(const ControlMesh& m, std::uint32_t trees) {
    const TopologyReport t = topology(m.cage);
    EXPECT_TRUE(t.sound());
    EXPECT_EQ(t.components, trees);
    EXPECT_EQ(t.euler, 2 * static_cast<std::int64_t>(trees));
    EXPECT_EQ(t.vertices, m.cage.positions.size()) << "every vertex is used";
}

TEST(BuildControlMesh, EverySkeletonInTheZooGivesOneSpherePerTree) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const ControlMesh m = cage_of(skeleton);
        expect_spheres(m, skeleton.tree_count());
        for (std::size_t v = 0; v < m.anchors.size(); ++v) {
            ASSERT_TRUE(is_finite(m.cage.positions[v]));
            ASSERT_TRUE(is_finite(m.anchors[v]));
        }
    }
}

TEST(BuildControlMesh, EveryPartedSkeletonInTheZooGivesOneSpherePerTree) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const PartResult parted = part_branches(skeleton, {});
        EXPECT_EQ(parted.skeleton.tree_count(), skeleton.tree_count());
        expect_spheres(build_control_mesh(parted.skeleton, parted.source, {}, {}), skeleton.tree_count());
    }
}

TEST(BuildControlMesh, EverySideCountCloses) {
    for (const int sides : {4, 8, 16}) {
        for (const auto& [name, skeleton] : skeleton_zoo()) {
            SCOPED_TRACE(name + " with " + std::to_string(sides) + " sides");
            expect_spheres(cage_of(skeleton, {.sides = sides}), skeleton.tree_count());
        }
    }
}

TEST(BuildControlMesh, AChainHasOneRingPerNodeAndACapAtEachEnd) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}},
                     {0.1f, 0.1f, 0.1f});
    EXPECT_EQ(cage_of(s).cage.positions.size(), 3u * 4);
    EXPECT_EQ(cage_of(s).cage.quads.size(), 2u * 4 + 2);
    EXPECT_EQ(cage_of(s, {.sides = 8}).cage.quads.size(), 2u * 8 + 2 * 4);
}

// Two poles of valence 6 are all that a fork costs; each tip adds the four corners of its cap.
TEST(BuildControlMesh, AForkHasTwoIrregularPoles) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 1}, {0.7f, 0, 1.7f}, {-0.7f, 0, 1.7f}}, {0.1f, 0.1f, 0.08f, 0.08f});
    const ControlMesh m = cage_of(s);
    EXPECT_EQ(m.cage.quads.size(), 3u * 4 + 3);
    EXPECT_EQ(topology(m.cage).irregular_vertices, 2u + 3 * 4);
}

TEST(BuildControlMesh, AnOpenBaseLeavesOneHoleOfFourEdges) {
    const Skeleton s({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 1}}, {0.1f, 0.1f});
    const TopologyReport t = topology(cage_of(s, {.base = BaseShape::open}).cage);
    EXPECT_EQ(t.open_edges, 4u);
    EXPECT_EQ(t.non_manifold_edges, 0u);
    EXPECT_EQ(t.euler, 1);
}

TEST(BuildControlMesh, FlatEndsAreCutAtTheirNodes) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}},
                     {0.1f, 0.1f, 0.1f});
    const ControlMesh m = cage_of(s, {.tips = TipShape::flat, .base = BaseShape::flat});
    EXPECT_EQ(m.clip[1].normal, (Vec3{0, 0, -1}));
    EXPECT_FLOAT_EQ(m.clip[1].offset, 0);
    EXPECT_EQ(m.clip[2].normal, (Vec3{0, 0, 1}));
    EXPECT_FLOAT_EQ(m.clip[2].offset, 2);
}

TEST(BuildControlMesh, SameBitsForAnyNumberOfThreads) {
    const Skeleton s = zoo_skeleton("random_large_hard");
    const ControlMesh one = cage_of(s, {}, 1);
    for (const unsigned threads : {2u, 7u}) {
        const ControlMesh m = cage_of(s, {}, threads);
        EXPECT_EQ(m.cage.positions, one.cage.positions);
        EXPECT_EQ(m.cage.quads, one.cage.quads);
        EXPECT_EQ(m.anchors, one.anchors);
    }
}

TEST(BuildControlMesh, RefusesAnOddNumberOfSides) {
    EXPECT_THROW(cage_of(zoo_skeleton("one_segment"), {.sides = 6}), InvalidInput);
}

}  // namespace
}  // namespace coppice
