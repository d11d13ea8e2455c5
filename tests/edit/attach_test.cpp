#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/edit/join.h"
#include "coppice/skeleton/random_tree.h"
#include "edit/trees.h"
#include "errors.h"
#include "zoo.h"

namespace coppice {
namespace {

using test::error_of;
using test::id;
using test::ids;
using test::near;

/// A stem of radius 0.1 along the z axis, and trees with roots inside it at z = 0.5, off its axis; on its
/// axis at z = 1.5; and outside.
Skeleton superimposed() {
    const NodeId none;
    return Skeleton({none, NodeId(0), none, NodeId(2), none, NodeId(4), none, NodeId(6)},
                    {{0, 0, 0},
                     {0, 0, 2},
                     {0.05f, 0, 0.5f},
                     {1, 0, 1},
                     {0, 0, 1.5f},
                     {-1, 0, 2},
                     {0.5f, 0, 0},
                     {1, 0, 0}},
                    {0.1f, 0.1f, 0.2f, 0.15f, 0.05f, 0.04f, 0.1f, 0.1f});
}

TEST(Attach, ConnectsTreesWithRootsInsideBranches) {
    EditableTree tree(superimposed());
    const EditChange change = attach(tree, tree.nodes());
    EXPECT_EQ(tree.skeleton().tree_count(), 2u);
    EXPECT_TRUE(near(tree.position(tree.parent(id(2))), {0, 0, 0.5f}));
    EXPECT_FLOAT_EQ(tree.radius(id(2)), 0.1f);  // limited to the radius of the stem
    EXPECT_FLOAT_EQ(tree.radius(id(3)), 0.1f);
    EXPECT_EQ(change.removed, ids({4}));  // on the axis: replaced by the node of the stem
    EXPECT_TRUE(near(tree.position(tree.parent(id(5))), {0, 0, 1.5f}));
    EXPECT_TRUE(tree.is_root(id(6)));
    tree.undo();
    EXPECT_TRUE(test::same(tree.skeleton(), superimposed()));
}

TEST(Attach, NeverConnectsATreeToItself) {
    // Each root is inside the other branch.
    const NodeId none;
    EditableTree tree(Skeleton({none, NodeId(0), none, NodeId(2)},
                               {{0, 0, 0}, {0, 0, 1}, {0.01f, 0, 0.02f}, {1, 0, 0}},
                               {0.1f, 0.1f, 0.1f, 0.1f}));
    attach(tree, tree.nodes());
    EXPECT_EQ(tree.skeleton().tree_count(), 1u);
    EXPECT_NE(error_of([&] { attach(tree, ids({1})); }).find("no root is selected"), std::string::npos);
}

/// Creates trees from chains of positions, each with one radius; the first position is a root, or an existing
/// node.
class Chains {
  public:
    Chains& add(const std::vector<Vec3>& places, float radius, int on = -1) {
        NodeId last = on < 0 ? NodeId::none() : NodeId(static_cast<std::uint32_t>(on));
        for (const Vec3 p : places) {
            parents_.push_back(last);
            positions_.push_back(p);
            radii_.push_back(radius);
            last = NodeId(static_cast<std::uint32_t>(parents_.size()) - 1);
        }
        return *this;
    }
    EditableTree tree() const { return EditableTree(Skeleton(parents_, positions_, radii_)); }

  private:
    std::vector<NodeId> parents_;
    std::vector<Vec3> positions_;
    std::vector<float> radii_;
};

TEST(AttachCrossings, CutsTheThinnerBranchInsideTheThicker) {
    EditableTree tree = Chains()
                            .add({{0, 0, 0}, {0, 0, 2}}, 0.1f)
                            .add({{-1, 0.02f, 1}, {-0.5f, 0.02f, 1}, {1, 0.02f, 1}, {2, 0, 1}}, 0.05f)
                            .tree();
    const Skeleton before = tree.skeleton();
    EXPECT_TRUE(attach(tree, tree.nodes()).empty());
    const EditChange change = attach(tree, tree.nodes(), Crossings::join);
    ASSERT_EQ(change.added, ids({6, 7}));
    EXPECT_EQ(tree.parent(id(6)),
              id(3));  // the inner portion ends at the closest point to the axis of the stem
    EXPECT_TRUE(tree.is_tip(id(6)));
    EXPECT_TRUE(near(tree.position(id(6)), {0, 0.02f, 1}));
    EXPECT_EQ(tree.parent(id(4)), id(7));  // the outer portion is attached to the stem
    EXPECT_EQ(tree.parent(id(1)), id(7));
    EXPECT_TRUE(near(tree.position(id(7)), {0, 0, 1}));
    EXPECT_EQ(tree.skeleton().tree_count(), 2u);
    EXPECT_TRUE(attach(tree, tree.nodes(), Crossings::join).empty());  // there are no more crossings to join
    tree.undo();
    EXPECT_TRUE(test::same(tree.skeleton(), before));
}

TEST(AttachCrossings, CutsABranchAtEveryBranchItPasses) {
    EditableTree tree = Chains()
                            .add({{0, 0, 0}, {0, 0, 2}}, 0.1f)
                            .add({{1, 0, 0}, {1, 0, 2}}, 0.1f)
                            .add({{2, 0, 0}, {2, 0, 2}}, 0.1f)
                            .add({{-1, 0, 1}, {3, 0, 1}}, 0.05f)
                            .tree();
    attach(tree, tree.nodes(), Crossings::join);
    EXPECT_EQ(tree.size(), 14u);
    EXPECT_TRUE(near(tree.position(tree.parent(id(7))), {2, 0, 1}));
    EXPECT_EQ(tree.find_root(id(7)), id(4));
    EXPECT_EQ(tree.skeleton().tree_count(), 4u);
    for (const std::uint32_t root :
         {0u, 2u, 6u}) {  // a section of the branch ends in each stem except the last
        float farthest = -1;
        tree.visit_subtree(id(root), [&](StableId n) { farthest = std::max(farthest, tree.position(n).x); });
        EXPECT_NEAR(farthest, root == 6 ? 0.0f : root == 0 ? 1.0f : 2.0f, 1e-5f);
    }
}

TEST(AttachCrossings, CutsTheOuterOfTwoConnectedBranches) {
    // A twig that returns through its parent limb and is thicker than it.
    EditableTree tree = Chains()
                            .add({{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {3, 0, 1}}, 0.1f)
                            .add({{1, 0, 2}, {2.5f, 0, 2}, {2.5f, 0, 0}}, 0.1f, 2)
                            .tree();
    const EditChange change = attach(tree, tree.nodes(), Crossings::join);
    EXPECT_EQ(change.reparented, ids({4, 7}));  // 4 because the limb is split
    EXPECT_TRUE(near(tree.position(tree.parent(id(7))), {2.5f, 0, 1}));
    EXPECT_EQ(tree.parent(tree.parent(id(7))), id(3));
}

TEST(AttachCrossings, PreservesBranchesThatStartOrEndInsideAndUnselectedOnes) {
    EditableTree plain(test::stem_with_branches());
    EXPECT_TRUE(attach(plain, plain.nodes(), Crossings::join).empty());
    // At an acute angle, over several segments inside the parent branch.
    EditableTree acute = Chains()
                             .add({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}}, 0.2f)
                             .add({{0.05f, 0, 1.5f}, {0.1f, 0, 2}, {0.3f, 0, 2.5f}}, 0.15f, 1)
                             .tree();
    EXPECT_TRUE(attach(acute, acute.nodes(), Crossings::join).empty());
    EditableTree ends = Chains()
                            .add({{0, 0, 0}, {0, 0, 2}}, 0.1f)
                            .add({{-1, 0, 1}, {0.05f, 0, 1}}, 0.05f)
                            .add({{0.05f, 1, 1}, {0.05f, -1, 1}}, 0.02f)
                            .tree();
    EXPECT_TRUE(attach(ends, ids({2, 3}), Crossings::join).empty());
    EXPECT_FALSE(attach(ends, ids({5}), Crossings::join).empty());
}

TEST(AttachCrossings, AcceptsTheZooAndJoinsFewerTheSecondTime) {
    std::size_t first = 0, second = 0;
    const auto joins = [&](const Skeleton& skeleton) {
        EditableTree tree(skeleton);
        const Skeleton before = tree.skeleton();
        first += attach(tree, tree.nodes(), Crossings::join).reparented.size();
        EXPECT_LE(tree.skeleton().tree_count(), before.tree_count());
        second += attach(tree, tree.nodes(), Crossings::join).reparented.size();
        while (tree.undo_depth() > 0) tree.undo();
        EXPECT_TRUE(test::same(tree.skeleton(), before));
    };
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        joins(skeleton);
    }
    for (std::uint64_t seed = 1; seed < 9; ++seed) joins(random_tree(500, seed));
    EXPECT_GT(first, 0u);
    EXPECT_LT(second, first / 4);
}

}  // namespace
}  // namespace coppice
