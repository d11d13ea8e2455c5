#include "coppice/base/vec.h"

#include <gtest/gtest.h>

#include <limits>

#include "coppice/base/random.h"

namespace coppice {
namespace {

constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

TEST(Vec3, AddsAndScalesByComponent) {
    const Vec3 a{1, 2, 3}, b{5, -7, 0.5f};
    EXPECT_EQ(a + b, (Vec3{6, -5, 3.5f}));
    EXPECT_EQ(a - b, (Vec3{-4, 9, 2.5f}));
    EXPECT_EQ(-a, (Vec3{-1, -2, -3}));
    EXPECT_EQ(a * 2.0f, (Vec3{2, 4, 6}));
    EXPECT_EQ(2.0f * a, a * 2.0f);
    EXPECT_EQ(a / 2.0f, (Vec3{0.5f, 1, 1.5f}));
    Vec3 c = a;
    c += b;
    c -= a;
    c *= 4;
    EXPECT_EQ(c, (Vec3{20, -28, 2}));
}

TEST(Vec3, IndexesThreeComponents) {
    Vec3 a{1, 2, 3};
    a[0] = 4;
    a[1] = 5;
    a[2] = 6;
    EXPECT_EQ(a, (Vec3{4, 5, 6}));
    const Vec3 same = a;
    EXPECT_EQ(same[0], 4);
    EXPECT_EQ(same[1], 5);
    EXPECT_EQ(same[2], 6);
    EXPECT_EQ(Vec3(), (Vec3{0, 0, 0}));
    EXPECT_NE(a, (Vec3{4, 5, 7}));
}

TEST(Vec3, ConvertsPrecisionOnlyExplicitly) {
    static_assert(!std::is_convertible_v<Vec3d, Vec3>);
    static_assert(!std::is_convertible_v<Vec3, Vec3d>);
    EXPECT_EQ(Vec3(Vec3d{0.1, 0.5, 1e-50}), (Vec3{0.1f, 0.5f, 0}));
    EXPECT_EQ(Vec3d(Vec3{0.1f, 0.5f, 2}), (Vec3d{static_cast<double>(0.1f), 0.5, 2}));
}

TEST(Vec3, ComputesDotAndCrossProducts) {
    const Vec3 a{1, 2, 3}, b{4, -5, 6};
    EXPECT_EQ(dot(a, b), 12);                    // 4 - 10 + 18
    EXPECT_EQ(cross(a, b), (Vec3{27, 6, -13}));  // 12 + 15, 12 - 6, -5 - 8
    EXPECT_EQ(cross(kX, kY), kZ);                // right-handed
    EXPECT_EQ(cross(kY, kZ), kX);
    EXPECT_EQ(cross(kZ, kX), kY);
}

TEST(Vec3, ComputesLengthsAndInterpolation) {
    EXPECT_EQ(length_squared(Vec3{2, -3, 6}), 49);  // 4 + 9 + 36
    EXPECT_EQ(length(Vec3{2, -3, 6}), 7);
    EXPECT_EQ(distance(Vec3{1, 1, 1}, Vec3{3, -2, 7}), 7);
    EXPECT_EQ(lerp(Vec3{1, 2, 3}, Vec3{5, 2, 1}, 0.25f), (Vec3{2, 2, 2.5f}));
}

TEST(Vec3, NormalizedHasLengthOneAndPreservesTheDirection) {
    EXPECT_EQ(normalized(Vec3{0, -5, 0}), (Vec3{0, -1, 0}));
    const Vec3d n = normalized(Vec3d{2, -3, 6});
    EXPECT_DOUBLE_EQ(n.x, 2.0 / 7);
    EXPECT_DOUBLE_EQ(n.y, -3.0 / 7);
    EXPECT_DOUBLE_EQ(n.z, 6.0 / 7);
    EXPECT_EQ(normalized(Vec3{0, 1e-15f, 0}), kY);  // short, but it still has a direction
}

TEST(Vec3, NormalizedZeroIsTheFallback) {
    EXPECT_EQ(normalized(Vec3{}), kZ);
    EXPECT_EQ(normalized(Vec3{}, kX), kX);
    EXPECT_EQ(normalized(Vec3{1e-30f, 0, 0}, kX), kX);  // its square is 0 as a float
    EXPECT_EQ(normalized(Vec3d{1e-31, 0, 0}, {0, 1, 0}), (Vec3d{0, 1, 0}));
}

TEST(Vec3, PerpendicularIsAUnitVectorAtARightAngle) {
    const CounterRandom random(1, 1);
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const auto at = [&](std::uint64_t k) { return static_cast<float>(random.uniform(3 * i + k, -1, 1)); };
        const Vec3 a = normalized(Vec3{at(0), at(1), at(2)});
        const Vec3 p = perpendicular(a);
        EXPECT_NEAR(dot(a, p), 0, 4e-7) << i;  // a few roundings of 6e-8
        EXPECT_NEAR(length(p), 1, 4e-7) << i;
    }
    EXPECT_EQ(perpendicular(kZ), kX);
    EXPECT_EQ(dot(perpendicular(-kZ), kZ), 0);
    EXPECT_EQ(length(perpendicular(-kZ)), 1);
    // Both signs of z = 0, where the formula switches.
    EXPECT_EQ(dot(perpendicular(Vec3{1, 0, 0.0f}), kX), 0);
    EXPECT_EQ(dot(perpendicular(Vec3{1, 0, -0.0f}), kX), 0);
}

TEST(Vec3, IsFiniteIfEveryComponentIsFinite) {
    EXPECT_TRUE(is_finite(Vec3{1, -2, std::numeric_limits<float>::max()}));
    for (const float bad : {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN()}) {
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 v{1, 2, 3};
            v[axis] = bad;
            EXPECT_FALSE(is_finite(v)) << axis << " " << bad;
        }
    }
}

}  // namespace
}  // namespace coppice
