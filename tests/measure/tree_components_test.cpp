#include "coppice/measure/tree_components.h"
#include "measure/support.h"

#include <gtest/gtest.h>

#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

// Nodes at heights 0, 1, 2 ... along a pole of radius 0.5; ten metres away, a second one of two nodes.
const Skeleton kPole({kRoot, NodeId(0), NodeId(1), NodeId(2)}, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 10}},
                     {0.5f, 0.5f, 0.5f, 0.5f});
const Skeleton kTwo({kRoot, NodeId(0), kRoot, NodeId(2)}, {{0, 0, 0}, {0, 0, 10}, {10, 0, 0}, {10, 0, 10}},
                    {0.5f, 0.5f, 0.5f, 0.5f});

PolygonMesh adjacent(PolygonMesh mesh, float x) {
    for (Vec3& p : mesh.positions) p.x += x;
    return mesh;
}

TEST(TreeParts, OfWholeTreesHaveNoLooseComponents) {
    const TreeComponentsReport one = compute_tree_components(capsule(16, 8, 0.5f, 0, 10), kPole);
    EXPECT_EQ(one, (TreeComponentsReport{.trees = 1, .parts = 1}));
    const PolygonMesh pole = capsule(16, 8, 0.5f, 0, 10);
    EXPECT_EQ(compute_tree_components(both(pole, adjacent(pole, 10)), kTwo),
              (TreeComponentsReport{.trees = 2, .parts = 2}));
}

TEST(TreeParts, OfMergedTreesAreFewerThanTrees) {
    EXPECT_EQ(compute_tree_components(box({-1, -1, -1}, {11, 1, 11}), kTwo),
              (TreeComponentsReport{.trees = 2, .parts = 1}));
}

TEST(TreeParts, ReportsTheNodeOfASeveredBranch) {
    const PolygonMesh torn = both(capsule(16, 8, 0.5f, 2.6f, 10), capsule(16, 32, 0.5f, 0, 1.4f));
    const TreeComponentsReport r = compute_tree_components(torn, kPole);
    EXPECT_EQ(r.parts, 2u);
    EXPECT_EQ(r.loose, 1u);
    EXPECT_FALSE(r.whole());
    // The lower one has more faces, and is therefore assigned to the tree.
    ASSERT_EQ(r.largest.size(), 1u);
    EXPECT_EQ(r.largest[0].node, NodeId(3));
    EXPECT_EQ(r.largest[0].place, (Vec3d{0, 0, 10}));
    EXPECT_EQ(r.largest[0].faces, capsule(16, 8, 0.5f, 2.6f, 10).face_count());
}

TEST(TreeParts, FindsASeveredBranchNextToMergedTrees) {
    const PolygonMesh pole = capsule(16, 8, 0.5f, 0, 8);
    PolygonMesh joined = both(pole, adjacent(pole, 10));
    joined.add_face(std::vector<std::uint32_t>{0, 1, static_cast<std::uint32_t>(pole.positions.size())});
    const TreeComponentsReport r =
        compute_tree_components(both(joined, adjacent(capsule(4, 1, 0.5f, 9, 9.5f), 10)), kTwo);
    EXPECT_EQ(r.trees, 2u);
    EXPECT_EQ(r.parts, 2u);
    EXPECT_EQ(r.loose, 1u);
    EXPECT_EQ(r.largest[0].node, NodeId(3));
}

TEST(TreeParts, CountsHollowsAndSmallComponentsBySize) {
    const PolygonMesh solid = capsule(32, 32, 0.5f, 0, 10);
    const PolygonMesh hollow = inverted(capsule(8, 4, 0.1f, 4, 5)), bubble = adjacent(cube(), 3);
    const TreeComponentsReport r = compute_tree_components(both(both(solid, bubble), hollow), kPole);
    EXPECT_EQ(r.loose, 2u);
    ASSERT_EQ(r.largest.size(), 2u);
    EXPECT_EQ(r.largest[0].faces, hollow.face_count());
    EXPECT_EQ(r.largest[1].faces, 6u);
}

TEST(TreeParts, ConvertsTheOriginOfTreesOfOneNode) {
    const Skeleton balls({kRoot, kRoot, NodeId(1)}, {{0, 0, 0}, {5, 0, 0}, {5, 0, 4}}, {1, 1, 1},
                         {100, 0, 0});
    PolygonMesh mesh = both(box({49, -1, -1}, {51, 1, 1}), box({54, -1, -1}, {56, 1, 5}));
    mesh.origin = {50, 0, 0};
    EXPECT_TRUE(compute_tree_components(mesh, balls).whole());
}

}  // namespace
}  // namespace coppice
