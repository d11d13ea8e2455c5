#include "coppice/measure/cone_union.h"
#include "measure/support.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

ConeUnion round_union(const Skeleton& s) { return {s, s.origin(), EndShape::round, EndShape::round}; }

TEST(ConeUnion, ContainsPointsWithinTheLocalRadius) {
    const Skeleton s({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {1, 2});
    const ConeUnion solid = round_union(s);
    EXPECT_TRUE(solid.contains({1.45, 0, 5}));  // the radius is 1.5 in the middle
    EXPECT_FALSE(solid.contains({1.55, 0, 5}));
    EXPECT_TRUE(solid.contains({0, 0, 11.9}));
    EXPECT_FALSE(solid.contains({0, 0, 12.1}));
    EXPECT_TRUE(solid.contains({0, 0, -0.9}));
}

TEST(ConeUnion, ContainsTreesOfOneNode) {
    const Skeleton s({kRoot, kRoot}, {{0, 0, 0}, {9, 0, 0}}, {1, 2}, {100, 0, 0});
    const ConeUnion solid(s, {99, 0, 0}, EndShape::flat, EndShape::flat);
    EXPECT_EQ(solid.capsules().size(), 2u);
    EXPECT_TRUE(solid.contains({1.9, 0, 0}));
    EXPECT_TRUE(solid.contains({11.9, 0, 0}));
    EXPECT_FALSE(solid.contains({12.1, 0, 0}));
    EXPECT_TRUE(solid.cuts().empty());
}

TEST(ConeUnion, FlatEndsCutHalfBallsAndAdjacentSegments) {
    // The first node is half a radius above the root, so its ball extends below the root.
    const Skeleton s({kRoot, NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 0.5f}, {0, 0, 10}}, {1, 1, 1});
    const ConeUnion flat_base(s, {}, EndShape::flat, EndShape::round);
    EXPECT_TRUE(flat_base.contains({0, 0, 0.01}));
    EXPECT_FALSE(flat_base.contains({0, 0, -0.01}));
    EXPECT_TRUE(flat_base.contains({0, 0, 10.9}));
    const ConeUnion flat_tips(s, {}, EndShape::round, EndShape::flat);
    EXPECT_TRUE(flat_tips.contains({0, 0, -0.9}));
    EXPECT_FALSE(flat_tips.contains({0, 0, 10.01}));
    ASSERT_EQ(flat_tips.cuts().size(), 1u);
    EXPECT_EQ(flat_tips.cuts()[0].outward, Vec3d(0, 0, 1));
}

TEST(ConeUnion, CutsAreLimitedToTheirEnd) {
    // A branch from far up comes down next to the trunk and crosses the root's plane.
    const Skeleton s({kRoot, NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 10}, {0, 0, 20}, {2, 0, -10}}, {1, 1, 1, 0.5f});
    const ConeUnion solid(s, {}, EndShape::flat, EndShape::round);
    EXPECT_TRUE(solid.contains({2, 0, -9}));
    EXPECT_TRUE(solid.contains({1, 0, -0.1}));  // not a segment that begins near the root
    EXPECT_FALSE(solid.contains({0, 0, -0.1}));
}

TEST(ConeUnion, ARootWithTwoChildrenHasNoBase) {
    const Skeleton s({kRoot, NodeId(0), NodeId(0)}, {{0, 0, 0}, {0, 0, 5}, {5, 0, 0}}, {1, 1, 1});
    EXPECT_TRUE(ConeUnion(s, {}, EndShape::flat, EndShape::round).cuts().empty());
}

TEST(ConeUnion, ContainsTheBallOfARootThickerThanItsBranches) {
    const Skeleton soma({kRoot, NodeId(0), NodeId(0)}, {{0, 0, 0}, {0, 0, 5}, {5, 0, 0}}, {4, 0.5f, 0.4f});
    EXPECT_TRUE(round_union(soma).contains({0, 0, 3.9}));
    EXPECT_TRUE(round_union(soma).contains({-3.9, 0, 0}));
    EXPECT_TRUE(round_union(soma).contains({0, 2.7, 2.7}));
    EXPECT_FALSE(round_union(soma).contains({0, 2.9, 2.9}));
    // If the stems of a root with several stems are long, the leader's cone contains the ball.
    const Skeleton stool({kRoot, NodeId(0), NodeId(0)}, {{0, 0, 0}, {0, 0, 50}, {50, 0, 0}}, {4, 0.5f, 0.4f});
    EXPECT_EQ(round_union(stool).capsules().size(), 2u);
}

}  // namespace
}  // namespace coppice
