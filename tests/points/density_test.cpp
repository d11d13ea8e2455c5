#include "coppice/points/sampling/density.h"

#include <gtest/gtest.h>

#include <limits>

#include "points/support.h"

namespace coppice {
namespace {

using points_support::error_of;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(DensityCurve, KindsHaveTheirDefinition) {
    const DensityCurve uniform(PointDensity::uniform, 0.5f);
    EXPECT_EQ(uniform.at(0.5f), 0);
    EXPECT_EQ(uniform.at(0.51f), 1);
    EXPECT_EQ(uniform.at(100), 1);
    EXPECT_EQ(uniform.at(kNan), 0);
    const DensityCurve proportional(PointDensity::proportional, 0.5f, 0.1f, 2);
    EXPECT_EQ(proportional.at(0.4f), 0);
    EXPECT_DOUBLE_EQ(proportional.at(1), 4);  // (1 / 0.5)^2
    const DensityCurve inverse(PointDensity::inverse, 0.5f);
    EXPECT_DOUBLE_EQ(inverse.at(1), 0.5);
    const DensityCurve inside(PointDensity::inside_boundary, 0.5f, 0.25f);
    EXPECT_EQ(inside.at(0.5f), 0);
    EXPECT_EQ(inside.at(0.6f), 1);
    EXPECT_EQ(inside.at(0.75f), 0);
    const DensityCurve outside(PointDensity::outside_boundary, 0.5f, 0.25f);
    EXPECT_EQ(outside.at(0.25f), 0);
    EXPECT_EQ(outside.at(0.4f), 1);
    EXPECT_EQ(outside.at(0.5f), 0);
    EXPECT_EQ(outside.shell_width(), 0.25f);
    EXPECT_EQ(inverse.shell_width(), 0);
}

TEST(DensityCurve, IsLinearBetweenKnotsWithStepsAtRepeatedOnes) {
    const DensityCurve curve({{0, 0}, {1, 2}, {1, 5}, {2, 1}});
    EXPECT_EQ(curve.at(-0.1f), 0);
    EXPECT_DOUBLE_EQ(curve.at(0.5f), 1);
    EXPECT_DOUBLE_EQ(curve.at(1), 5);
    EXPECT_DOUBLE_EQ(curve.at(1.5f), 3);
    EXPECT_DOUBLE_EQ(curve.at(2), 1);
    EXPECT_EQ(curve.at(2.1f), 0);
}

TEST(DensityCurve, RangesContainEveryValue) {
    const DensityCurve curves[] = {
        DensityCurve(PointDensity::uniform, 0.5f), DensityCurve(PointDensity::proportional, 0.5f, 0.1f, 3),
        DensityCurve(PointDensity::inverse, 0.5f), DensityCurve(PointDensity::inside_boundary, 0.5f, 0.2f),
        DensityCurve({{0, 0}, {0.4f, 2}, {0.4f, 5}, {1.2f, 1}})};
    for (const DensityCurve& curve : curves) {
        for (int a = 0; a < 30; ++a) {
            for (int b = a; b < 30; ++b) {
                const float low = 0.05f * static_cast<float>(a), high = 0.05f * static_cast<float>(b);
                const auto [least, largest] = curve.over(low, high);
                for (int k = 0; k <= 8; ++k) {
                    const double d = curve.at(low + (high - low) * static_cast<float>(k) / 8);
                    EXPECT_LE(least, d * (1 + 1e-6) + 1e-6);
                    EXPECT_GE(largest, d * (1 - 1e-6) - 1e-6);
                }
            }
        }
    }
    EXPECT_EQ(curves[0].over(0.6f, 2).least, 1);  // flat: cells completely inside have a known density
    EXPECT_EQ(curves[0].over(0.1f, 0.4f).largest, 0);
    EXPECT_EQ(curves[0].over(kNan, 2).largest, 1);
}

TEST(DensityCurve, ShellWidthIsTheRangeOfValuesWithADensity) {
    EXPECT_EQ(DensityCurve(PointDensity::uniform, 0.5f).shell_width(), 0);
    EXPECT_EQ(DensityCurve(PointDensity::outside_boundary, 0.5f, 0.125f).shell_width(), 0.125f);
    EXPECT_EQ(DensityCurve({{0.25f, 1}, {0.5f, 1}}).shell_width(), 0.25f);
    // The density increases from 0 at 1 and is 0 again at 3; knots farther out have no effect.
    EXPECT_EQ(DensityCurve({{0, 0}, {1, 0}, {2, 1}, {3, 0}, {7, 0}}).shell_width(), 2);
}

TEST(DensityCurve, RejectsInvalidDensities) {
    for (const float width : {0.0f, -1.0f, kNan, kInfinity}) {
        EXPECT_NE(error_of([&] { DensityCurve(PointDensity::inside_boundary, 1, width); }).find("width"),
                  std::string::npos);
    }
    EXPECT_NE(error_of([] { DensityCurve(PointDensity::inside_boundary, 1, 1e-12f); }).find("too small"),
              std::string::npos);
    EXPECT_NE(error_of([] { DensityCurve(PointDensity::proportional, 1, 1, kNan); }).find("power"),
              std::string::npos);
    EXPECT_NE(error_of([] { DensityCurve(PointDensity::inverse, 0); }).find("above 0"), std::string::npos);
    EXPECT_NE(error_of([] { DensityCurve(PointDensity::uniform, kNan); }).find("iso value"),
              std::string::npos);
    EXPECT_NE(error_of([] { DensityCurve({{0, 1}}); }).find("two knots"), std::string::npos);
    EXPECT_NE(error_of([] { DensityCurve({{1, 1}, {0, 1}}); }).find("must not decrease"), std::string::npos);
    EXPECT_NE(error_of([] { DensityCurve({{0, 0}, {1, 0}}); }).find("0 everywhere"), std::string::npos);
    EXPECT_NE(error_of([] { DensityCurve({{0, 1}, {0, 1}}); }).find("0 everywhere"), std::string::npos);
    for (const float d : {-1.0f, kNan, 1e7f}) {
        EXPECT_NE(error_of([&] { DensityCurve({{0, 1}, {1, d}}); }).find("knot 2"), std::string::npos);
    }
}

}  // namespace
}  // namespace coppice
