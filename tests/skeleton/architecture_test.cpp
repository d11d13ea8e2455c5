#include "coppice/skeleton/architecture.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/skeleton/measure.h"
#include "zoo.h"

namespace coppice {
namespace {

constexpr double kPi = std::numbers::pi;

/// A stem 0-1-2 of radius 2 with a branch 3-4 from node 1, from which 5 branches off, and a second tree 6-7.
Skeleton two_trees() {
    return Skeleton(
        {NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3), NodeId(3), NodeId::none(), NodeId(6)},
        {{0, 0, 0}, {0, 0, 1}, {0, 0, 3}, {1, 0, 1}, {2, 0, 1}, {1, 1, 1}, {9, 0, 0}, {9, 0, 5}},
        {2, 2, 2, 1, 1, 0.5f, 1, 1});
}

TEST(Architecture, AxisOrdersFollowTheThickestChild) {
    EXPECT_EQ(axis_orders(two_trees()), (std::vector<std::uint32_t>{0, 0, 0, 1, 1, 2, 0, 0}));
    const std::vector<BranchOrder> orders = branch_orders(two_trees());
    ASSERT_EQ(orders.size(), 3u);
    EXPECT_EQ(orders[0].branches, 2u);
    EXPECT_EQ(orders[1].branches, 1u);
    EXPECT_EQ(orders[2].branches, 1u);
    EXPECT_DOUBLE_EQ(orders[0].length, 8);
    EXPECT_DOUBLE_EQ(orders[1].length, 2);
    EXPECT_NEAR(orders[1].volume, 2 * kPi, 1e-12);
    EXPECT_NEAR(orders[2].volume, 0.25 * kPi, 1e-12);
}

TEST(Architecture, GivenOrdersAndAxesAreUsed) {
    // A stem with a second segment of another axis of the same order, and a branch of order 3.
    const Skeleton s({NodeId(), NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 1}, {0, 0, 3}, {4, 0, 1}}, {1, 1, 1, 0.5f});
    const std::vector<std::uint32_t> order{0, 0, 0, 3}, axis{5, 5, 6, 5};
    const std::vector<BranchOrder> orders = branch_orders(s, order, axis);
    ASSERT_EQ(orders.size(), 4u);
    EXPECT_EQ(orders[0].branches, 2u);
    EXPECT_DOUBLE_EQ(orders[0].length, 3);
    EXPECT_EQ(orders[1].branches + orders[2].branches, 0u);
    EXPECT_EQ(orders[3].branches, 1u);
    EXPECT_DOUBLE_EQ(orders[3].length, 4);
}

TEST(Architecture, StrahlerOrdersIncreaseWhereTwoMaximumOrdersMeet) {
    EXPECT_EQ(strahler_orders(two_trees()), (std::vector<std::uint32_t>{2, 2, 1, 2, 1, 1, 1, 1}));
    // A full binary tree of depth 3: order 4 at the root; a chain keeps its order.
    std::vector<NodeId> parent{NodeId::none(), NodeId(0)};
    for (std::uint32_t i = 2; i < 16; ++i) parent.push_back(NodeId(i / 2));
    std::vector<Vec3> position;
    for (std::uint32_t i = 0; i < parent.size(); ++i) position.push_back({float(i), float(i * i), 0});
    const Skeleton tree(parent, position, std::vector<float>(parent.size(), 1));
    const auto order = strahler_orders(tree);
    EXPECT_EQ(order[0], 4u);
    EXPECT_EQ(order[1], 4u);
    EXPECT_EQ(order[2], 3u);
    EXPECT_EQ(order[15], 1u);
    // Three children of one order count as two: the order increases by one.
    const Skeleton fan({NodeId::none(), NodeId(0), NodeId(0), NodeId(0)},
                       {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {1, 1, 1, 1});
    EXPECT_EQ(strahler_orders(fan)[0], 2u);
}

TEST(Architecture, SegmentsAreSplitAtTheBoundsOfDiameterClasses) {
    // A cone of diameters 4 to 0.8 over 8 m: 1/4 of it is thicker than 3.2, 3/4 than 1.6.
    const Skeleton cone({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 8}}, {2, 0.4f});
    const auto classes = diameter_classes(cone, std::array{0.5, 1.6, 3.2});
    ASSERT_EQ(classes.size(), 4u);
    EXPECT_EQ(classes[0].length, 0);
    EXPECT_NEAR(classes[1].length, 2, 1e-6);
    EXPECT_NEAR(classes[2].length, 4, 1e-6);
    EXPECT_NEAR(classes[3].length, 2, 1e-6);
    EXPECT_TRUE(std::isinf(classes[3].to));
    EXPECT_EQ(classes[2].from, 1.6);
    EXPECT_NEAR(classes[3].volume, kPi / 3 * 2 * (4 + 2 * 1.6 + 1.6 * 1.6), 1e-5);
    EXPECT_THROW(diameter_classes(cone, std::array{0.5, 0.5}), InvalidInput);
    EXPECT_THROW(diameter_classes(cone, std::array{0.0}), InvalidInput);
    // A diameter equal to a limit belongs to the class that begins there.
    const Skeleton rod({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 8}}, {0.5f, 0.5f});
    EXPECT_EQ(diameter_classes(rod, std::array{1.0})[1].length, 8);
}

TEST(Architecture, ClassesAndOrdersSumToTheWhole) {
    const Skeleton tree = zoo_skeleton("fork_60");
    const SkeletonMeasures whole = measure(tree);
    double length = 0, volume = 0, area = 0, of_orders = 0;
    for (const DiameterClass& c : diameter_classes(tree, std::array{0.01, 0.1, 0.15, 0.2, 1.0})) {
        length += c.length;
        volume += c.volume;
        area += c.area;
    }
    for (const BranchOrder& o : branch_orders(tree)) of_orders += o.volume;
    EXPECT_NEAR(length, whole.length, 1e-9 * whole.length);
    EXPECT_NEAR(volume, whole.volume, 1e-6 * whole.volume);
    EXPECT_NEAR(area, whole.area, 1e-6 * whole.area);
    EXPECT_NEAR(of_orders, whole.volume, 1e-9 * whole.volume);
}

TEST(Sholl, CountsIntersectionsWithSpheresAroundEachRoot) {
    // Tree one: the stem crosses 1, 2 and 3, the branch's ends are at sqrt(2) and sqrt(5), its twig at
    // sqrt(3). Tree two crosses 1 to 5.
    const ShollProfile profile = sholl(two_trees(), 1);
    EXPECT_EQ(profile.crossings, (std::vector<std::uint64_t>{2, 3, 2, 1, 1}));
    EXPECT_EQ(profile.most(), 3u);
    EXPECT_EQ(profile.critical_radius(), 2);
}

TEST(Sholl, SegmentsThatEnterASphereIntersectItTwice) {
    // Out to (3, 4), across to (-3, 4): the minimum distance to the root is 4.
    const Skeleton bent({NodeId::none(), NodeId(0), NodeId(1)}, {{0, 0, 0}, {3, 4, 0}, {-3, 4, 0}},
                        {1, 1, 1});
    EXPECT_EQ(sholl(bent, 1).crossings, (std::vector<std::uint64_t>{1, 1, 1, 1, 3}));
}

TEST(Sholl, RejectsInvalidSteps) {
    EXPECT_THROW(sholl(two_trees(), -1), InvalidInput);
    EXPECT_THROW(sholl(two_trees(), 1e-9), InvalidInput);
    EXPECT_EQ(sholl(two_trees()).crossings.size(), 100u);
    EXPECT_TRUE(sholl(zoo_skeleton("single_node"), 1).crossings.empty());
    EXPECT_EQ(sholl(zoo_skeleton("single_node"), 1).critical_radius(), 0);
}

}  // namespace
}  // namespace coppice
