#include "coppice/edit/thickness.h"

#include <gtest/gtest.h>

#include <cmath>

#include "edit/trees.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;
using test::id;
using test::ids;

TEST(Thickness, SetsAndScalesRadii) {
    EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(set_radii(tree, ids({6, 7}), 0.01).resized, ids({6, 7}));
    scale_radii(tree, ids({6}), 3);
    EXPECT_FLOAT_EQ(tree.radius(id(6)), 0.03f);
    EXPECT_EQ(error_of([&] { set_radii(tree, ids({1}), 0); }),
              "the radius 0 is not above 0; enter a finite number above 0");
    EXPECT_EQ(error_of([&] { scale_radii(tree, ids({1}), INFINITY); }),
              "the factor inf is not above 0; enter a finite number above 0");
}

TEST(Thickness, TapersAlongTheLength) {
    EditableTree tree(test::stem_with_branches());
    taper(tree, ids({4}), 0, 0.01);  // 0.05, and 2 m to the tip
    EXPECT_FLOAT_EQ(tree.radius(id(4)), 0.05f);
    EXPECT_FLOAT_EQ(tree.radius(id(5)), 0.03f);
    EXPECT_FLOAT_EQ(tree.radius(id(6)), 0.01f);
    EXPECT_FLOAT_EQ(tree.radius(id(7)), 0.02f);
}

TEST(Thickness, SmoothsAlongAxes) {
    EditableTree tree(test::stem_with_branches());
    set_radii(tree, ids({5}), 0.08);
    smooth_radii(tree, tree.nodes());
    EXPECT_FLOAT_EQ(tree.radius(id(5)), 0.06f);  // half of 0.08, and a quarter each of 0.05 and 0.03
    EXPECT_FLOAT_EQ(tree.radius(id(4)), 0.05f);  // the first node of its axis
}

TEST(Thickness, AppliesThePipeModelTowardsTheRoot) {
    EditableTree tree(test::stem_with_branches());
    const EditChange change = pipe_radii(tree, ids({7}), 2);
    EXPECT_EQ(change.resized, ids({0, 1, 4, 5}));
    const double five = std::hypot(0.03, 0.02);
    EXPECT_FLOAT_EQ(tree.radius(id(5)), static_cast<float>(five));
    EXPECT_FLOAT_EQ(tree.radius(id(1)), static_cast<float>(std::hypot(five, 0.08)));  // 2 keeps its radius
    tree.undo();
    pipe_radii(tree, tree.nodes(), 2);  // all paths at once: each node after its children
    const double two = std::hypot(0.06, 0.02);
    EXPECT_FLOAT_EQ(tree.radius(id(0)), static_cast<float>(std::hypot(five, two)));
    EXPECT_FLOAT_EQ(tree.radius(id(3)), 0.06f);
}

}  // namespace
}  // namespace coppice
