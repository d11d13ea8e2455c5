#include "coppice/edit/join.h"

#include <gtest/gtest.h>

#include "coppice/edit/cut.h"
#include "edit/trees.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;
using test::id;
using test::ids;
using test::near;

TEST(Draw, SnapsToTheNearestAxis) {
    EditableTree tree(test::stem_with_branches());
    const std::vector<Vec3d> points{{0.05, 0, 1.5}, {-0.5, 0, 1.7}, {-1, 0, 2.1}};
    const EditChange change = draw(tree, points);
    ASSERT_EQ(change.added, ids({9, 10, 11}));
    EXPECT_TRUE(near(tree.position(id(9)), {0, 0, 1.5f}));  // the closest point, on the segment to 2
    EXPECT_EQ(tree.parent(id(2)), id(9));
    EXPECT_EQ(tree.parent(id(10)), id(9));
    // Half of the radius 0.09 of the stem at the closest point, and a quarter of that at the tip.
    EXPECT_FLOAT_EQ(tree.radius(id(11)), 0.01125f);
    EXPECT_GT(tree.radius(id(10)), tree.radius(id(11)));
}

TEST(Draw, RejectsPointsFarFromAnyAxisUnlessAlone) {
    EditableTree tree(test::stem_with_branches());
    const std::vector<Vec3d> points{{0, 4, 1.5}, {0, 5, 2}};
    EXPECT_EQ(error_of([&] { draw(tree, points); }),
              "the first point is 3.64 m from the nearest axis, at node 7, with the radius 0.02 m; begin "
              "nearer, raise "
              "snap, or draw it alone");
    const EditChange change = draw(tree, points, {.radius = 0.2, .alone = true});
    EXPECT_TRUE(tree.is_root(change.added[0]));
    EXPECT_FLOAT_EQ(tree.radius(change.added[0]), 0.2f);
    EXPECT_NE(error_of([&] {
                  draw(tree, {points.data(), 1});
              }).find("two points or more"),
              std::string::npos);
}

TEST(Append, AddsANode) {
    EditableTree tree(test::stem_with_branches());
    append(tree, id(6), {0, 0, 1});
    EXPECT_TRUE(near(tree.position(id(9)), {3, 0, 2}));
    EXPECT_FLOAT_EQ(tree.radius(id(9)), 0.03f);
}

TEST(Graft, MovesABranchToAnotherHost) {
    EditableTree tree(test::stem_with_branches());
    const EditChange change = graft(tree, id(4), id(3));
    EXPECT_EQ(change.reparented, ids({4}));
    EXPECT_EQ(change.moved, ids({4, 5, 6, 7}));
    EXPECT_TRUE(near(tree.position(id(4)), {1, 0, 3}));
    tree.undo();
    graft(tree, id(8), id(5),
          {.along = 0.5});  // the segment to 5 is from x = 1 to 2, with radius 0.05 to 0.04
    EXPECT_TRUE(near(tree.position(tree.parent(id(8))), {1.5f, 0, 1}));
    EXPECT_TRUE(near(tree.position(id(8)), {0.5f, 0, 1}));
    tree.undo();
    graft(tree, id(8), id(5), {.align = true});  // from a parent branch along z to one along x: -x becomes z
    EXPECT_TRUE(near(tree.position(id(8)), {2, 0, 2}));
}

TEST(Graft, LimitsRadiiToTheHost) {
    EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(graft(tree, id(4), id(8)).resized, ids({4, 5, 6}));
    EXPECT_FLOAT_EQ(tree.radius(id(4)), 0.02f);
    tree.undo();
    EXPECT_TRUE(graft(tree, id(4), id(8), {.limit_radius = false}).resized.empty());
}

// A separate skeleton is attached with its root at the parent node, and gets new ids.
TEST(Graft, AttachesASeparateSkeleton) {
    EditableTree tree(test::stem_with_branches());
    const Skeleton twig({NodeId::none(), NodeId(0), NodeId(1)}, {{5, 5, 5}, {5, 6, 5}, {5, 7, 6}},
                        {0.3f, 0.3f, 0.01f});
    const EditChange change = graft(tree, twig, id(3));
    EXPECT_EQ(change.added, ids({9, 10}));
    EXPECT_TRUE(change.moved.empty());
    EXPECT_EQ(tree.parent(id(9)), id(3));
    EXPECT_EQ(tree.parent(id(10)), id(9));
    EXPECT_TRUE(near(tree.position(id(9)), {0, 1, 3}));
    EXPECT_TRUE(near(tree.position(id(10)), {0, 2, 4}));
    EXPECT_FLOAT_EQ(tree.radius(id(9)), 0.06f);  // that of the parent node
    EXPECT_FLOAT_EQ(tree.radius(id(10)), 0.01f);
    tree.undo();
    graft(tree, twig, id(3), {.along = 0.5, .limit_radius = false});
    EXPECT_TRUE(near(tree.position(tree.parent(id(10))), {0, 0, 2.5f}));
    EXPECT_TRUE(near(tree.position(id(10)), {0, 1, 2.5f}));
    EXPECT_FLOAT_EQ(tree.radius(id(10)), 0.3f);
    tree.undo();
    graft(tree, twig, id(6), {.align = true});  // along x: +z becomes +x
    EXPECT_TRUE(near(tree.position(id(10)), {4, 2, 1}));
    const Skeleton ball({NodeId::none()}, {{0, 0, 0}}, {1});
    EXPECT_NE(error_of([&] { graft(tree, ball, id(3)); }).find("single tree"), std::string::npos);
}

TEST(Graft, RestoresDetachedBranches) {
    EditableTree tree(test::stem_with_branches());
    detach(tree, ids({4}));
    const EditChange change = graft(tree, id(9), id(1));
    EXPECT_EQ(change.removed, ids({9}));
    EXPECT_TRUE(test::same(tree.skeleton(), test::stem_with_branches()) ||
                tree.skeleton().size() == test::stem_with_branches().size());
    for (const StableId n : tree.nodes())
        EXPECT_EQ(tree.position(n), EditableTree(test::stem_with_branches()).position(n));
}

TEST(Graft, RejectsCyclesAndSingleNodes) {
    EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(error_of([&] { graft(tree, id(4), id(7)); }),
              "node 7 hangs on node 4, so that 4 would be grafted into itself; choose a host outside the "
              "subtree of 4");
    EXPECT_NE(error_of([&] { graft(tree, id(4), id(4)); }).find("grafted into itself"), std::string::npos);
    EXPECT_NE(error_of([&] { graft(tree, id(0), id(6)); }).find("grafted into itself"), std::string::npos);
    const std::vector<Vec3d> points{{0, 9, 0}, {0, 9, 1}};
    draw(tree, points, {.alone = true});
    remove_branches(tree, ids({10}));
    EXPECT_NE(error_of([&] { graft(tree, id(9), id(1)); }).find("a tree of a single node"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice
