#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/extract/tree/circle_fit_internal.h"

namespace coppice::extract_internal {
namespace {

std::vector<PlanePoint> arc(double from, double to, int count, double noise) {
    std::vector<PlanePoint> points;
    const CounterRandom random(2, 3);
    for (int i = 0; i < count; ++i) {
        const double turn = std::lerp(from, to, (i + 0.5) / count);
        const double r = 0.5 + noise * random.uniform(static_cast<std::uint64_t>(i), -1, 1);
        points.push_back({3 + r * std::cos(turn), -2 + r * std::sin(turn), 1});
    }
    return points;
}

TEST(CircleFit, IsExactWithoutNoise) {
    const CircleFit fit = fit_circle(arc(0, 2 * std::numbers::pi, 7, 0), 10);
    EXPECT_TRUE(fit.good);
    EXPECT_NEAR(fit.x, 3, 1e-9);
    EXPECT_NEAR(fit.y, -2, 1e-9);
    EXPECT_NEAR(fit.radius, 0.5, 1e-9);
    EXPECT_EQ(fit.used, 7u);
}

TEST(CircleFit, FitsAHalfCircle) {
    const CircleFit fit = fit_circle(arc(0, std::numbers::pi, 60, 0.01), 10);
    EXPECT_TRUE(fit.good);
    EXPECT_NEAR(fit.x, 3, 0.01);
    EXPECT_NEAR(fit.y, -2, 0.01);
    EXPECT_NEAR(fit.radius, 0.5, 0.01);
    // Uniform noise of +-0.01 has a root mean square of 0.01 / sqrt(3) = 0.0058.
    EXPECT_NEAR(fit.residual, 0.0058, 0.001);
}

TEST(CircleFit, ExcludesOutliers) {
    auto points = arc(0, 2 * std::numbers::pi, 40, 0.005);
    for (int i = 0; i < 10; ++i) points.push_back({3.8 + 0.05 * i, -2.2, 1});
    const CircleFit fit = fit_circle(points, 10);
    EXPECT_TRUE(fit.good);
    EXPECT_EQ(fit.used, 40u);
    EXPECT_NEAR(fit.radius, 0.5, 0.005);
}

TEST(CircleFit, ReportsAmbiguousPoints) {
    EXPECT_FALSE(fit_circle(arc(0, 2 * std::numbers::pi, 5, 0), 10).good);      // too few
    EXPECT_FALSE(fit_circle(arc(0, 0.5, 40, 0.01), 10).good);                   // a short arc
    EXPECT_FALSE(fit_circle(arc(0, 2 * std::numbers::pi, 40, 0), 0.4).good);    // larger than the maximum
    EXPECT_FALSE(fit_circle(std::vector<PlanePoint>(20, {1, 1, 1}), 10).good);  // coincident points
    std::vector<PlanePoint> line;
    for (int i = 0; i < 20; ++i) line.push_back({0.1 * i, 0.2 * i, 1});
    EXPECT_FALSE(fit_circle(line, 1).good);
}

}  // namespace
}  // namespace coppice::extract_internal
