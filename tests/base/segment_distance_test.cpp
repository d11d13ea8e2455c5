#include "coppice/base/kernel/segment_distance.h"

#include <gtest/gtest.h>

#include "coppice/base/random.h"

namespace coppice {
namespace {

TEST(ClosestParameter, IsTheFootOfThePerpendicularWithinTheSegment) {
    const Vec3d a{1, 0, 0}, d{4, 0, 0};
    EXPECT_EQ(closest_parameter(Vec3d{2, 7, 0}, a, d), 0.25);  // (2 - 1) / 4
    EXPECT_EQ(closest_parameter(Vec3d{-3, 1, 0}, a, d), 0);    // before the start
    EXPECT_EQ(closest_parameter(Vec3d{9, 1, 1}, a, d), 1);     // beyond the end
}

TEST(ClosestParameter, ReturnsTheGivenParameterForASegmentOfLengthZero) {
    EXPECT_EQ(closest_parameter(Vec3d{1, 2, 3}, {0, 0, 0}, {0, 0, 0}), 0);
    EXPECT_EQ(closest_parameter(Vec3d{1, 2, 3}, {0, 0, 0}, {0, 0, 0}, 0.5), 0.5);
}

TEST(SegmentDistance, IsComputedForSkewSegments) {
    // Along x at height 0 and along y at height 3, above (1, 0): a quarter and a half of the way.
    const Vec3d a0{0, 0, 0}, a1{4, 0, 0}, b0{1, -2, 3}, b1{1, 2, 3};
    const ClosestParameters c = closest_parameters(a0, a1, b0, b1);
    EXPECT_DOUBLE_EQ(c.on_a, 0.25);
    EXPECT_DOUBLE_EQ(c.on_b, 0.5);
    EXPECT_DOUBLE_EQ(segment_distance(a0, a1, b0, b1), 3);
}

TEST(SegmentDistance, IsZeroForIntersectingSegments) {
    EXPECT_DOUBLE_EQ(segment_distance({-1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}), 0);
}

TEST(SegmentDistance, IsComputedBetweenEnds) {
    // From (1, 0, 0) to (4, 4, 0): 3 and 4 make 5.
    EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {1, 0, 0}, {4, 4, 0}, {8, 8, 0}), 5);
    // The end of one segment near the middle of the other.
    EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {4, 0, 0}, {2, 1, 0}, {2, 9, 0}), 1);
    EXPECT_DOUBLE_EQ(segment_distance({2, 1, 0}, {2, 9, 0}, {0, 0, 0}, {4, 0, 0}), 1);
}

TEST(SegmentDistance, IsComputedForParallelSegments) {
    EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {4, 0, 0}, {1, 2, 0}, {9, 2, 0}), 2);  // parallel
    EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {4, 0, 0}, {9, 2, 0}, {1, 2, 0}), 2);  // antiparallel
    EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {1, 0, 0}, {4, 4, 0}, {9, 4, 0}),
                     5);  // parallel without overlap
    EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {9, 0, 0}), 2);  // collinear
    EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {3, 0, 0}, {1, 0, 0}, {9, 0, 0}),
                     0);  // collinear with overlap
}

TEST(SegmentDistance, IsComputedForSegmentsOfLengthZero) {
    EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {0, 0, 0}, {1, 2, 2}, {1, 2, 2}), 3);  // 1 + 4 + 4
    EXPECT_DOUBLE_EQ(segment_distance({2, 5, 0}, {2, 5, 0}, {0, 0, 0}, {4, 0, 0}), 5);
    EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {4, 0, 0}, {2, 5, 0}, {2, 5, 0}), 5);
    EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {4, 0, 0}, {7, 4, 0}, {7, 4, 0}),
                     5);  // beyond the end: 3, 4
}

// The minimum distance among `steps` points per segment: too large by at most half a step of each.
double sampled_distance(Vec3d a0, Vec3d a1, Vec3d b0, Vec3d b1, int steps) {
    double least = distance(a0, b0);
    for (int i = 0; i <= steps; ++i) {
        const Vec3d p = lerp(a0, a1, static_cast<double>(i) / steps);
        for (int k = 0; k <= steps; ++k)
            least = std::min(least, distance(p, lerp(b0, b1, static_cast<double>(k) / steps)));
    }
    return least;
}

TEST(SegmentDistance, IsTheMinimumOverAllPairsOfPoints) {
    constexpr int kSteps = 50;
    const CounterRandom random(1, 1);
    std::uint64_t draw = 0;
    const auto point = [&] {
        const double x = random.uniform(draw++, -1, 1), y = random.uniform(draw++, -1, 1);
        return Vec3d{x, y, random.uniform(draw++, -1, 1)};
    };
    for (int i = 0; i < 300; ++i) {
        const Vec3d a0 = point(), a1 = point(), b0 = point();
        // Every third pair is parallel except for 1e-8, where rounding decides which points are closest: any
        // of them are, to about this accuracy.
        const Vec3d b1 = i % 3 == 0 ? b0 + (a1 - a0) * 0.7 + point() * 1e-8 : point();
        const double exact = segment_distance(a0, a1, b0, b1);
        const double sampled = sampled_distance(a0, a1, b0, b1, kSteps);
        EXPECT_LE(exact, sampled + 1e-7) << i;
        EXPECT_GE(exact, sampled - (distance(a0, a1) + distance(b0, b1)) / (2 * kSteps)) << i;
        EXPECT_NEAR(exact, segment_distance(b0, b1, a0, a1), 1e-7) << i;
    }
}

}  // namespace
}  // namespace coppice
