#include "coppice/edit/deform.h"

#include <gtest/gtest.h>

#include <numbers>

#include "edit/trees.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;
using test::id;
using test::ids;
using test::near;

constexpr double kQuarter = std::numbers::pi / 2;

/// A horizontal branch of 20 segments of 0.1 m along x on a stem along z, with a lateral along y in its
/// middle.
EditableTree level_branch() {
    std::vector<NodeId> parent{NodeId::none(), NodeId(0), NodeId(1)};
    std::vector<Vec3> place{{0, 0, 0}, {0, 0, 1}, {0, 0, 2}};
    std::vector<float> radius{0.1f, 0.1f, 0.09f};
    for (std::uint32_t i = 1; i <= 20; ++i) {
        parent.emplace_back(i == 1 ? 1 : i + 1);
        place.emplace_back(0.1f * static_cast<float>(i), 0, 1);
        radius.push_back(0.05f);
    }
    parent.emplace_back(12);
    place.emplace_back(1.0f, 0.5f, 1);
    radius.push_back(0.02f);
    return EditableTree(Skeleton(parent, place, radius));
}

TEST(Bend, PreservesTheFirstSegmentAndTurnsTheLastByTheAngle) {
    EditableTree tree = level_branch();
    bend(tree, ids({3}), kQuarter);
    EXPECT_TRUE(near(tree.position(id(3)), {0.1f, 0, 1}));
    const Vec3 last = tree.position(id(22)) - tree.position(id(21));
    EXPECT_TRUE(near(last, {0, 0, -0.1f}));
    for (std::uint32_t i = 4; i <= 22; ++i)  // lengths are preserved
        EXPECT_NEAR(distance(tree.position(id(i)), tree.position(id(i - 1))), 0.1, 1e-6);
    EXPECT_NEAR(distance(tree.position(id(23)), tree.position(id(12))), 0.5, 1e-6);
    EXPECT_NEAR(tree.position(id(23)).y, 0.5, 1e-6);  // the bend is about y
}

TEST(Bend, RejectsASingleSegment) {
    EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(error_of([&] { bend(tree, ids({8}), 1); }),
              "the axis of node 8 has a single segment, which cannot bend; resample or split it first");
    EXPECT_EQ(error_of([&] {
                  bend(tree, ids({4, 8}), 1);
              }),
              "the axis of node 8 has a single segment, which cannot bend; resample or split it first");
    EXPECT_TRUE(test::same(tree.skeleton(), test::stem_with_branches()));
}

TEST(Twist, TurnsLateralsInProportionToTheLength) {
    EditableTree tree = level_branch();
    const EditChange change = twist(tree, ids({3}), 2 * kQuarter);
    EXPECT_EQ(change.moved, ids({23}));  // half of the angle: a quarter turn about x maps y to z
    EXPECT_TRUE(near(tree.position(id(23)), {1, 0, 1.5f}));
}

TEST(Straighten, PreservesJointAndTip) {
    EditableTree tree = level_branch();
    bend(tree, ids({3}), kQuarter);
    const Vec3 tip = tree.position(id(22));
    straighten(tree, ids({3}));
    EXPECT_EQ(tree.position(id(22)), tip);
    const Vec3 way = normalized(tip - tree.position(id(1)));
    for (std::uint32_t i = 3; i <= 22; ++i)
        EXPECT_LT(length(cross(way, tree.position(id(i)) - tree.position(id(1)))), 1e-5f);
}

TEST(Smooth, HalvesAKinkAndMovesLateralsAlong) {
    EditableTree tree = level_branch();
    move_node(tree, id(12), {1.0, 0, 1.1}, 0.05);  // a kink at a single node
    EXPECT_TRUE(near(tree.position(id(12)), {1, 0, 1.1f}));
    EXPECT_TRUE(near(tree.position(id(11)), {0.9f, 0, 1}));
    const Vec3 lateral = tree.position(id(23)) - tree.position(id(12));
    smooth(tree, ids({12}));  // half of the way to the midpoint
    EXPECT_TRUE(near(tree.position(id(12)), {1, 0, 1.05f}));
    EXPECT_TRUE(near(tree.position(id(23)) - tree.position(id(12)), lateral));
}

TEST(MoveNode, MovesTheNodeAndPreservesLengthsAndFarNodes) {
    EditableTree tree = level_branch();
    const EditChange change = move_node(tree, id(12), {1.0, 0, 1.2}, 0.55);
    EXPECT_TRUE(near(tree.position(id(12)), {1, 0, 1.2f}));
    EXPECT_TRUE(near(tree.position(id(6)), {0.4f, 0, 1}));
    EXPECT_TRUE(near(tree.position(id(18)), {1.6f, 0, 1}));
    EXPECT_EQ(change.moved.front(), id(7));
    for (std::uint32_t i = 7; i <= 17; ++i)
        EXPECT_NEAR(distance(tree.position(id(i)), tree.position(id(i - 1))), 0.108, 0.01);
    // Close to a smooth curve: each turn is less than half of the turn if only the node moved.
    for (std::uint32_t i = 7; i <= 17; ++i) {
        const Vec3 in = normalized(tree.position(id(i)) - tree.position(id(i - 1)));
        const Vec3 out = normalized(tree.position(id(i + 1)) - tree.position(id(i)));
        EXPECT_GT(dot(in, out), 0.9f);
    }
}

TEST(MoveNode, MovesTheTipWithTheEndOfItsBranch) {
    EditableTree tree = level_branch();
    move_node(tree, id(22), {1.9, 0.3, 1});  // the tip itself; the branch follows up to the stem
    EXPECT_TRUE(near(tree.position(id(22)), {1.9f, 0.3f, 1}));
    EXPECT_TRUE(near(tree.position(id(1)), {0, 0, 1}));
    for (std::uint32_t i = 4; i <= 22; ++i)
        EXPECT_NEAR(distance(tree.position(id(i)), tree.position(id(i - 1))), 0.1, 0.006);
    tree.undo();
    move_node(tree, id(20), {1.8, 0.2, 1});
    EXPECT_NEAR(distance(tree.position(id(20)), tree.position(id(22))), 0.2, 0.01);  // the end follows
    EXPECT_GT(tree.position(id(22)).y, 0.2f);
}

TEST(MoveNode, MovesASingleRoot) {
    EditableTree tree(Skeleton({NodeId::none()}, {{0, 0, 0}}, {0.1f}));
    move_node(tree, id(0), {1, 2, 3});
    EXPECT_EQ(tree.position(id(0)), (Vec3{1, 2, 3}));
}

}  // namespace
}  // namespace coppice
