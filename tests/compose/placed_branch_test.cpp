#include "coppice/compose/placed_branch.h"

#include <gtest/gtest.h>

#include <numbers>

#include "coppice/base/error.h"

namespace coppice {
namespace {

constexpr float kTurn = std::numbers::pi_v<float> / 2;

// A branch at a right angle to a parent branch of radius 0.1 m, along +z in its own frame, with the parent
// branch towards +x.
ChildTree straight() {
    return {.skeleton = {{NodeId::none(), NodeId(0), NodeId(1)},
                         {{0, 0, 0}, {0, 0, 1}, {0.2f, 0, 2}},
                         {0.05f, 0.05f, 0.04f}},
            .parent_radius = 0.1f,
            .inclination = kTurn};
}

// A stem along z, with laterals of 1 m at 2 m height towards the given sides.
Skeleton stem(const std::vector<Vec3>& sides, Vec3d origin = {}) {
    std::vector<NodeId> parents{NodeId::none(), NodeId(0), NodeId(1)};
    std::vector<Vec3> positions{{0, 0, 0}, {0, 0, 2}, {0, 0, 4}};
    std::vector<float> radii{0.1f, 0.1f, 0.1f};
    for (const Vec3 side : sides) {
        parents.push_back(NodeId(1));
        positions.push_back(Vec3{0, 0, 2} + side);
        radii.push_back(0.05f);
    }
    return Skeleton(std::move(parents), std::move(positions), std::move(radii), origin);
}

void expect_near(Vec3 a, Vec3 b) { EXPECT_LT(distance(a, b), 1e-5f) << a.x << " " << a.y << " " << a.z; }

TEST(PlacedBranch, StartsInTheGivenDirection) {
    const Skeleton tree = stem({}, {7, 0, 0});
    const Skeleton s =
        placed_branch(straight(), tree, find_parent_place(tree, NodeId(1)), {.direction = Vec3d{0, 3, 0}});
    EXPECT_EQ(s.origin(), tree.origin());
    expect_near(s.position(NodeId(0)), {0, 0, 2});
    expect_near(s.position(NodeId(1)), {0, 1, 2});
    expect_near(s.position(NodeId(2)),
                {0, 2, 2.2f});  // its +x is the direction in which the parent branch continues
    EXPECT_FLOAT_EQ(s.radius(NodeId(1)), 0.05f);
    EXPECT_THROW(placed_branch(straight(), tree, find_parent_place(tree, NodeId(1)), {.direction = Vec3d{}}),
                 InvalidInput);
}

TEST(PlacedBranch, RollRotatesItAboutItsAxis) {
    const Skeleton tree = stem({});
    const Skeleton s = placed_branch(straight(), tree, find_parent_place(tree, NodeId(1)),
                                     {.direction = Vec3d{0, 1, 0}, .roll = double{kTurn}});
    expect_near(s.position(NodeId(1)), {0, 1, 2});
    // Counter-clockwise seen against +y, z is rotated to x.
    expect_near(s.position(NodeId(2)), {0.2f, 2, 2});
}

// The parent branch is twice as thick as the original one: the first segment is longer by the difference.
TEST(PlacedBranch, PreservesTheGapToTheBark) {
    const Skeleton tree = stem({});
    const Skeleton s = placed_branch(straight(), tree, find_parent_place(tree, NodeId(1)),
                                     {.direction = Vec3d{0, 1, 0}, .scale = 0.5});
    expect_near(s.position(NodeId(1)), {0, 0.5f + 0.05f, 2});
    expect_near(s.position(NodeId(2)), {0, 1.0f + 0.05f, 2.1f});
    EXPECT_FLOAT_EQ(s.radius(NodeId(1)), 0.025f);
    ParentPlace thick = find_parent_place(tree, NodeId(1));
    thick.radius = 0.3;
    expect_near(placed_branch(straight(), tree, thick, {.direction = Vec3d{0, 1, 0}}).position(NodeId(1)),
                {0, 1.2f, 2});
}

TEST(PlacedBranch, StartsTowardsTheLargestFreeSide) {
    const auto side = [](const std::vector<Vec3>& others) {
        const Skeleton tree = stem(others);
        const Skeleton s = placed_branch(straight(), tree, find_parent_place(tree, NodeId(1)));
        return s.position(NodeId(1)) - Vec3{0, 0, 2};
    };
    expect_near(side({}), {1, 0, 0});  // all equal: the first
    expect_near(side({{1, 0, 0}}), {-1, 0, 0});
    expect_near(side({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}}), {0, -1, 0});
}

TEST(PlacedBranch, HostPlaceIsAPointOnASegment) {
    const Skeleton tree = stem({{2, 0, 0}});
    const ParentPlace half = find_parent_place(tree, NodeId(3), 0.5);
    EXPECT_LT(distance(half.position, Vec3d{1, 0, 2}), 1e-6);
    EXPECT_LT(distance(half.direction, Vec3d{1, 0, 0}), 1e-6);
    EXPECT_NEAR(half.radius, 0.5 * (double{tree.segment(NodeId(3)).radius_a} + 0.05), 1e-6);
    const ParentPlace root = find_parent_place(tree, NodeId(0), 0.5);
    EXPECT_LT(distance(root.position, Vec3d{}), 1e-6);
    EXPECT_LT(distance(root.direction, Vec3d{0, 0, 1}), 1e-6);
}

}  // namespace
}  // namespace coppice
