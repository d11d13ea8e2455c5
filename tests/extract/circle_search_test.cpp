#include "coppice/extract/stem/circle_search_internal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "coppice/base/random.h"

namespace coppice::extract_internal {
namespace {

constexpr double kPi = std::numbers::pi;

/// Returns an arc of radius 0.2 about (5, 3), with uniform noise.
std::vector<PlanePoint> arc(double from, double to, int count, double noise) {
    std::vector<PlanePoint> points;
    const CounterRandom random(5, 1);
    for (int i = 0; i < count; ++i) {
        const double turn = std::lerp(from, to, (i + 0.5) / count);
        const double r = 0.2 + noise * random.uniform(static_cast<std::uint64_t>(i), -1, 1);
        points.push_back({5 + r * std::cos(turn), 3 + r * std::sin(turn), 1});
    }
    return points;
}

/// Adds points of leaves in a square of 1 m that contains a third of the circle.
void add_clutter(std::vector<PlanePoint>& points, int count) {
    const CounterRandom random(6, 1);
    for (int i = 0; i < count; ++i) {
        const auto k = static_cast<std::uint64_t>(i);
        points.push_back({5.1 + random.uniform(2 * k), 2.5 + random.uniform(2 * k + 1), 1});
    }
}

TEST(CircleSearch, FindsACircleWithItsCoverageAndDeviation) {
    const FoundCircle c = find_circle(arc(0, 2 * kPi, 200, 0.004), {.noise = 0.004});
    EXPECT_NEAR(c.radius, 0.2, 0.001);
    EXPECT_NEAR(c.x, 5, 0.001);
    EXPECT_EQ(c.coverage, 1);
    // Uniform noise of +-4 mm has a root mean square of 2.3 mm; 36 sectors of four points each reduce it
    // to 2.3 / sqrt(144) = 0.19 mm.
    EXPECT_NEAR(c.residual, 0.0023, 0.0004);
    EXPECT_NEAR(c.deviation, 0.00019, 0.00004);
}

TEST(CircleSearch, FindsHalfAStemNextToLeaves) {
    std::vector<PlanePoint> points = arc(0.5 * kPi, 1.5 * kPi, 120, 0.003);
    add_clutter(points, 150);
    const FoundCircle c = find_circle(points, {.noise = 0.004});
    EXPECT_NEAR(c.radius, 0.2, 0.01);
    EXPECT_NEAR(c.x, 5, 0.01);
    EXPECT_GE(c.coverage, 0.45);
    EXPECT_GT(c.deviation, 0.0002);  // half of it determines the radius less than the whole
}

TEST(CircleSearch, FindsNothingAmongLeavesAlone) {
    std::vector<PlanePoint> points;
    add_clutter(points, 60);
    const FoundCircle c = find_circle(points, {.min_radius = 0.1, .max_radius = 0.3, .noise = 0.004});
    EXPECT_TRUE(c.used == 0 || c.coverage < 0.6 || c.inside > 0.5);
    EXPECT_EQ(find_circle({}, {}).used, 0u);
    EXPECT_EQ(find_circle(std::vector<PlanePoint>(50, {1, 1, 1}), {}).used, 0u);
}

TEST(CircleSearch, ContrastDistinguishesAStemFromEvenlyDistributedPoints) {
    const CircleSearch search{
        .min_radius = 0.1, .max_radius = 0.3, .noise = 0.008, .anywhere = false, .reach = 0.15};
    const double least = std::log(kPi * 0.15 * 0.15 * 0.2 / std::pow(2 * search.noise, 3) / 0.01);
    int passed = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        std::vector<PlanePoint> even, stem;
        const CounterRandom random(seed, 1);
        for (std::uint64_t k = 0; k < 80; ++k) {
            const double r = 0.45 * std::sqrt(random.uniform(2 * k)),
                         turn = 2 * kPi * random.uniform(2 * k + 1);
            even.push_back({r * std::cos(turn), r * std::sin(turn), 1});
            // A quarter of the points are leaves about a half-visible stem.
            if (k % 4 == 0)
                stem.push_back(even.back());
            else
                stem.push_back({0.2 * std::cos(0.5 * turn), 0.2 * std::sin(0.5 * turn), 1});
        }
        const FoundCircle found = find_circle(stem, search), chance = find_circle(even, search);
        EXPECT_GT(circle_contrast(stem, found, search.noise, 0.45), least) << seed;
        passed += chance.used > 0 && circle_contrast(even, chance, search.noise, 0.45) > least;
    }
    EXPECT_LE(passed, 2);
}

TEST(CircleSearch, SearchesTheGivenAreaOnly) {
    std::vector<PlanePoint> points = arc(0, 2 * kPi, 100, 0.001);
    for (const PlanePoint& p : arc(0, 2 * kPi, 300, 0.001)) points.push_back({p.x + 0.6, p.y, 1});
    const CircleSearch search{.noise = 0.004, .anywhere = false, .x = 5, .y = 3, .reach = 0.1};
    EXPECT_NEAR(find_circle(points, search).x, 5, 0.001);
}

TEST(CircleSearch, OutlineRadiusOfANonCircularSectionHasEqualArea) {
    // r = 0.2 (1 + 0.3 cos 3t): the circle of equal area has r^2 = 0.04 (1 + 0.09 / 2).
    std::vector<PlanePoint> points;
    for (int i = 0; i < 720; ++i) {
        const double t = i * kPi / 360, r = 0.2 * (1 + 0.3 * std::cos(3 * t));
        points.push_back({r * std::cos(t), r * std::sin(t), 1});
    }
    FoundCircle circle;
    circle.radius = 0.19;
    EXPECT_NEAR(outline_radius(points, circle, 0.004), 0.2 * std::sqrt(1.045), 0.001);
    points.resize(360);
    EXPECT_EQ(outline_radius(points, circle, 0.004), 0.19);
}

TEST(CircleSearch, ThinsToOnePointPerSquare) {
    std::vector<PlanePoint> points;
    for (int i = 0; i < 1000; ++i) points.push_back({0.001 * i, 0, 1});
    EXPECT_EQ(thin_plane(points, 0.1).size(), 10u);
}

}  // namespace
}  // namespace coppice::extract_internal
