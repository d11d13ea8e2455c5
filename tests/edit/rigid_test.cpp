#include "coppice/edit/rigid.h"

#include <gtest/gtest.h>

#include <numbers>

#include "coppice/skeleton/random_tree.h"
#include "edit/trees.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;
using test::id;
using test::ids;
using test::near;

constexpr double kQuarter = std::numbers::pi / 2;

TEST(Rigid, MovesABranchWithItsDescendants) {
    EditableTree tree(test::stem_with_branches());
    // 6 is a descendant of 4, and moves once
    const EditChange change = translate(tree, ids({4, 6}), {0, 0, 0.5});
    EXPECT_EQ(change.moved, ids({4, 5, 6, 7}));
    EXPECT_TRUE(near(tree.position(id(6)), {3, 0, 1.5f}));
}

TEST(Rigid, TurnsABranchAboutItsJoint) {
    EditableTree tree(test::stem_with_branches());
    rotate(tree, ids({4}), {.angle = kQuarter});  // about z at (0, 0, 1): x becomes y
    EXPECT_TRUE(near(tree.position(id(4)), {0, 1, 1}));
    EXPECT_TRUE(near(tree.position(id(7)), {-1, 2, 1}));
    tree.undo();
    rotate(tree, ids({4}), {.angle = kQuarter, .about = TurnAxis::own});  // about x: y becomes z
    EXPECT_TRUE(near(tree.position(id(6)), {3, 0, 1}));
    EXPECT_TRUE(near(tree.position(id(7)), {2, 0, 2}));
    tree.undo();
    rotate(tree, ids({4}), {.angle = kQuarter, .about = TurnAxis::side});  // up along its parent branch
    EXPECT_TRUE(near(tree.position(id(6)), {0, 0, 4}));
    tree.undo();
    rotate(tree, ids({5}), {.angle = kQuarter, .about = TurnAxis::host});  // its parent branch is along x
    EXPECT_TRUE(near(tree.position(id(7)), {2, 0, 2}));
}

TEST(Rigid, ScalesPositionsAndRadiiFromTheJoint) {
    EditableTree tree(test::stem_with_branches());
    scale(tree, ids({4}), 0.5);
    EXPECT_TRUE(near(tree.position(id(6)), {1.5f, 0, 1}));
    EXPECT_FLOAT_EQ(tree.radius(id(6)), 0.015f);
    EXPECT_FLOAT_EQ(tree.radius(id(1)), 0.1f);
    EXPECT_TRUE(scale(tree, ids({8}), 2, false).resized.empty());
}

TEST(Rigid, MirrorsABranchOrACopyOfIt) {
    EditableTree tree(test::stem_with_branches());
    mirror(tree, ids({4}), {1, 0, 0});
    EXPECT_TRUE(near(tree.position(id(7)), {-2, 1, 1}));
    tree.undo();
    const EditChange change = mirror(tree, ids({4}), {2, 0, 0}, true);
    EXPECT_EQ(change.added.size(), 4u);
    EXPECT_TRUE(change.moved.empty());
    EXPECT_EQ(tree.parent(change.added[0]), id(1));
    EXPECT_TRUE(near(tree.position(change.added[1]), {-2, 0, 1}));
}

TEST(Rigid, RejectsInvalidInput) {
    EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(error_of([&] {
                  translate(tree, {}, {1, 0, 0});
              }),
              "no node is selected; use select to list the nodes of a selection");
    EXPECT_EQ(error_of([&] { scale(tree, ids({1}), 0); }),
              "the factor 0 is not above 0; enter 0.5 for half the size");
    EXPECT_EQ(error_of([&] {
                  rotate(tree, ids({1}), {.angle = 1, .axis = {0, 0, 0}});
              }),
              "the axis has no direction; enter three numbers that are not all 0");
    EXPECT_NE(error_of([&] {
                  mirror(tree, ids({0}), {1, 0, 0}, true);
              }).find("node 0 is a root"),
              std::string::npos);
    EXPECT_NE(error_of([&] {
                  translate(tree, ids({40}), {1, 0, 0});
              }).find("there is no node 40"),
              std::string::npos);
    EXPECT_EQ(tree.undo_depth(), 0u);
}

/// Returns the bytes of history per node that an edit moves; checks that undo and redo are bit-identical.
template <class Edit>
double bytes_for_each_moved(const Skeleton& skeleton, const Edit& edit) {
    EditableTree tree(skeleton);
    const EditChange change = edit(tree);
    const Skeleton after = tree.skeleton();
    const double bytes = static_cast<double>(tree.history_bytes());
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(tree.undo().moved, change.moved);
        EXPECT_TRUE(test::same(tree.skeleton(), skeleton));
        EXPECT_EQ(tree.redo().moved, change.moved);
        EXPECT_TRUE(test::same(tree.skeleton(), after));
    }
    return bytes / static_cast<double>(change.moved.size());
}

// Rotating floats and back changes them: the history stores the motion of a limb, and the rounding errors.
TEST(Rigid, HistoryOfLimbsThatMoveRigidlyIsSmall) {
    const Skeleton tree = random_tree(4000, 7);
    const NodeSet top = ids({1});
    const auto bytes = [&](const auto& edit) { return bytes_for_each_moved(tree, edit); };
    EXPECT_LT(bytes([&](EditableTree& t) { return rotate(t, top, {.angle = 0.7}); }), 4.5);
    EXPECT_LT(bytes([&](EditableTree& t) { return translate(t, top, {0.1, -7, 1e-3}); }), 4.5);
    EXPECT_LT(bytes([&](EditableTree& t) { return mirror(t, top, {1, 2, 3}, false); }), 4.5);
    EXPECT_LT(bytes([&](EditableTree& t) { return scale(t, top, 1.7, false); }), 4.5);
    // Radii are stored individually; much smaller coordinates lose their last bits.
    EXPECT_LT(bytes([&](EditableTree& t) { return scale(t, top, 0.9, true); }), 10);
    EXPECT_LT(bytes([&](EditableTree& t) { return translate(t, top, {1e6, 0, 0}); }), 20);
    // An edit with two motions.
    const EditableTree whole(tree);
    StableId fork = whole.first_root();
    while (!whole.next_sibling(whole.first_child(fork))) fork = whole.first_child(fork);
    const NodeSet two{whole.first_child(fork), whole.next_sibling(whole.first_child(fork))};
    EXPECT_LT(bytes([&](EditableTree& t) { return rotate(t, two, {.angle = 0.7}); }), 6);
}

}  // namespace
}  // namespace coppice
