#include "coppice/compose/child_tree.h"

#include <gtest/gtest.h>

#include <numbers>

#include "coppice/base/error.h"
#include "coppice/skeleton/measure.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice {
namespace {

constexpr float kTurn = std::numbers::pi_v<float> / 2;

// A trunk of three segments, with a lateral of two segments towards +x that carries one towards +y.
Skeleton small_tree() {
    return {{NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3), NodeId(3)},
            {{5, 5, 0}, {5, 5, 1}, {5, 5, 2}, {6, 5, 1}, {7, 5, 1}, {6, 6, 1}},
            {0.2f, 0.2f, 0.15f, 0.1f, 0.08f, 0.05f}};
}

TEST(ChildTrees, AreAllBranchesOfBranchNodesInTheirOwnFrame) {
    const std::vector<ChildTree> trees = child_trees(small_tree());
    ASSERT_EQ(trees.size(), 4u);
    const ChildTree& lateral = trees[1];
    EXPECT_EQ(lateral.source_node, 3u);
    EXPECT_FALSE(lateral.leads);
    EXPECT_TRUE(trees[0].leads);
    EXPECT_FLOAT_EQ(lateral.parent_radius, 0.2f);
    EXPECT_NEAR(lateral.inclination, kTurn, 1e-6f);
    EXPECT_NEAR(trees[0].inclination, 0, 1e-3f);
    const Skeleton& s = lateral.skeleton;
    ASSERT_EQ(s.size(), 4u);
    EXPECT_EQ(s.position(NodeId(0)), Vec3(0, 0, 0));
    EXPECT_LT(distance(s.position(NodeId(1)), Vec3(0, 0, 1)), 1e-6f);
    EXPECT_LT(distance(s.position(NodeId(2)), Vec3(0, 0, 2)), 1e-6f);
    // World z is the direction of the parent branch, so x here; the frame is right-handed, so world y is -y.
    EXPECT_LT(distance(s.position(NodeId(3)), Vec3(0, -1, 1)), 1e-6f);
    EXPECT_FLOAT_EQ(s.radius(NodeId(0)), 0.1f);
}

TEST(ChildTrees, HaveMeasures) {
    const ChildTreeMeasures m = measure(child_trees(small_tree())[1]);
    EXPECT_NEAR(m.length, 3, 1e-6);
    EXPECT_NEAR(m.extent, 2, 1e-6);
    EXPECT_EQ(m.nodes, 4u);
    EXPECT_EQ(m.tips, 2u);
    EXPECT_EQ(m.orders, 2u);
    EXPECT_FLOAT_EQ(m.radius, 0.1f);
    EXPECT_GT(m.volume, 0);
}

TEST(ChildTrees, AreSelectedByLengthAndLeadership) {
    for (const ChildTree& t : child_trees(small_tree(), {.leaders = false})) EXPECT_FALSE(t.leads);
    EXPECT_EQ(child_trees(small_tree(), {.leaders = false}).size(), 2u);
    EXPECT_EQ(child_trees(small_tree(), {.min_length = 2}).size(), 1u);
    EXPECT_THROW(child_trees(small_tree(), {.min_length = -1}), InvalidInput);
}

TEST(ChildTrees, StartAtTheGivenNodes) {
    const auto trees = child_trees_at(small_tree(), {NodeId(5)});
    ASSERT_EQ(trees.size(), 1u);
    EXPECT_EQ(trees[0].source_node, 5u);
    EXPECT_THROW(child_trees_at(small_tree(), {NodeId(1)}), InvalidInput);
    EXPECT_THROW(child_trees_at(small_tree(), {NodeId(60)}), InvalidInput);
    EXPECT_THROW(child_trees_at(small_tree(), {NodeId(0)}), InvalidInput);
}

TEST(ChildTrees, PreserveLengthsAndRadii) {
    const Skeleton tree = random_tree(500, 3);
    const auto trees = child_trees(tree);
    ASSERT_GT(trees.size(), 100u);
    for (const ChildTree& t : trees) {
        const NodeId first(t.source_node);
        EXPECT_EQ(t.skeleton.radius(NodeId(1)), tree.radius(first));
        EXPECT_NEAR(distance(t.skeleton.position(NodeId(1)), t.skeleton.position(NodeId(0))),
                    distance(tree.position(first), tree.position(tree.parent(first))), 1e-5);
    }
}

}  // namespace
}  // namespace coppice
