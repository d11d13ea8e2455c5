#include "coppice/base/kernel/round_cone.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

// From (0, 0, 0) with radius 1 to (0, 0, 4) with radius 0.5.
constexpr Vec3d kA{0, 0, 0}, kB{0, 0, 4};

TEST(RoundCone, ComputesTheFootInsideAndBeyondTheSegment) {
    const RoundCone cone = round_cone(kA, kB, 1.0, 0.5);
    const RoundCone::ClosestPoint adjacent = cone.closest_point({3, 0, 2});
    EXPECT_DOUBLE_EQ(adjacent.t, 0.5);
    EXPECT_EQ(adjacent.offset, (Vec3d{3, 0, 0}));
    EXPECT_DOUBLE_EQ(adjacent.radius, 0.75);
    EXPECT_DOUBLE_EQ(adjacent.distance(), 3);
    EXPECT_DOUBLE_EQ(adjacent.signed_distance(), 2.25);
    EXPECT_DOUBLE_EQ(adjacent.relative_squared(), 16);

    EXPECT_DOUBLE_EQ(cone.closest_point({0, 0, -3}).t, 0);
    EXPECT_DOUBLE_EQ(cone.closest_point({0, 0, -3}).signed_distance(), 2);
    EXPECT_DOUBLE_EQ(cone.closest_point({0, 0, 5}).t, 1);
    EXPECT_DOUBLE_EQ(cone.closest_point({0, 0, 5}).signed_distance(), 0.5);
    EXPECT_DOUBLE_EQ(cone.closest_point({0.25, 0, 2}).signed_distance(), -0.5);  // inside
}

TEST(RoundCone, HasEndsAndLineParameter) {
    const RoundCone cone = round_cone(kA, kB, 1.0, 0.5);
    EXPECT_EQ(cone.b(), kB);
    EXPECT_DOUBLE_EQ(cone.radius_b(), 0.5);
    EXPECT_DOUBLE_EQ(cone.line_parameter({7, 0, 6}), 1.5);
    EXPECT_DOUBLE_EQ(cone.closest_point_at(0.25, {2, 0, 1}).signed_distance(), 2 - 0.875);
}

TEST(RoundCone, IsTheLargerBallForLengthZero) {
    for (const double a : {1.0, 2.0}) {
        const RoundCone ball = round_cone(kB, kB, a, 3 - a);
        EXPECT_DOUBLE_EQ(ball.closest_point({5, 0, 4}).signed_distance(), 3);
        EXPECT_DOUBLE_EQ(ball.line_parameter({5, 0, 4}), 0);
    }
    EXPECT_DOUBLE_EQ(round_cone(kB, kB, 2.0, 2.0).closest_point({5, 0, 4}).t, 1);
}

}  // namespace
}  // namespace coppice
