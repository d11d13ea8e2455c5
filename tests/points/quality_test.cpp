#include "coppice/points/quality.h"

#include <gtest/gtest.h>

#include <limits>

#include "coppice/base/random.h"
#include "points/support.h"

namespace coppice {
namespace {

using namespace points_support;

PointSet independent(std::size_t n) {
    PointSet set;
    const CounterRandom random(11, 0);
    for (std::size_t i = 0; i < n; ++i) {
        set.positions.push_back(
            Vec3(Vec3d(random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2))));
    }
    return set;
}

/// Returns 20^3 points at the centres of cubes, each moved by at most `jitter` of the edge.
PointSet lattice(float jitter) {
    PointSet set = independent(8000);
    for (int i = 0; i < 8000; ++i) {
        Vec3& p = set.positions[static_cast<std::size_t>(i)];
        const Vec3 cube(static_cast<float>(i % 20), static_cast<float>(i / 20 % 20),
                        static_cast<float>(i / 400));
        p = 0.05f * (cube + Vec3{0.5f, 0.5f, 0.5f} + jitter * (p - Vec3{0.5f, 0.5f, 0.5f}));
    }
    return set;
}

constexpr Box3 kCube{{0, 0, 0}, {1, 1, 1}};

TEST(Quality, DistancesAreExact) {
    const PointSet set = independent(2000);
    const QualityReport report = quality(set);
    EXPECT_NEAR(report.min_distance, min_distance(set), 1e-12);
    double mean = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
        double nearest = 9;
        for (std::size_t k = 0; k < set.size(); ++k) {
            if (k != i)
                nearest = std::min(nearest, distance(Vec3d(set.positions[i]), Vec3d(set.positions[k])));
        }
        mean += nearest / 2000;
    }
    EXPECT_NEAR(report.mean_distance, mean, 1e-12);
}

TEST(Quality, IndependentPointsHaveCurvesOfOne) {
    const QualityReport report = quality(independent(20000), kCube);
    EXPECT_NEAR(report.mean_spacing, std::cbrt(1 / 20000.0), 1e-9);
    EXPECT_NEAR(report.low_power, 1, 0.2);
    double distribution = 0, power = 0;
    for (std::size_t b = 16; b < 64; ++b) {
        EXPECT_NEAR(report.distribution[b], 1, 0.15);
        distribution += report.distribution[b] / 48;
        power += report.power[b] / 48;
    }
    // About 5000 points are centres, so that the density around them varies by 1.4 %: three times that.
    EXPECT_NEAR(distribution, 1, 0.042);
    EXPECT_NEAR(power, 1, 0.05);
}

TEST(Quality, ALatticeHasGapsAndNoLowFrequencies) {
    const QualityReport report = quality(lattice(0), kCube);
    EXPECT_NEAR(report.min_distance, 0.05, 1e-6);
    EXPECT_LT(report.low_power, 0.02);
    for (std::size_t b = 0; (static_cast<double>(b) + 1) * report.distance_step < 0.05; ++b) {
        EXPECT_EQ(report.distribution[b], 0);
    }
    EXPECT_LT(quality(lattice(1), kCube).low_power, 0.3);
}

TEST(Quality, IsBitIdenticalForAnyNumberOfThreads) {
    const PointSet set = independent(5000);
    EXPECT_EQ(quality(set, {}, {.threads = 1}), quality(set, {}, {.threads = 7}));
}

TEST(Quality, AcceptsFewAndCoincidentPoints) {
    EXPECT_EQ(quality({}).points, 0u);
    PointSet set;
    set.positions = {{1, 2, 3}};
    EXPECT_EQ(quality(set).min_distance, 0);
    set.positions.push_back({1, 2, 5});
    EXPECT_DOUBLE_EQ(quality(set).min_distance, 2);
    set.positions.assign(100000, Vec3{1, 2, 3});
    EXPECT_EQ(quality(set).min_distance, 0);
    set.positions.push_back({2, 3, 4});
    set.positions.push_back({0, 1, 2});
    const QualityReport heap = quality(set);
    EXPECT_EQ(heap.min_distance, 0);
    EXPECT_FALSE(quality_svg(heap).empty());
    EXPECT_FALSE(quality_svg({}).empty());
}

TEST(Quality, ImageContainsBothCurves) {
    const std::string svg = quality_svg(quality(independent(3000)));
    EXPECT_TRUE(svg.starts_with("<svg "));
    EXPECT_TRUE(svg.ends_with("</svg>\n"));
    EXPECT_NE(svg.find("Radial distribution"), std::string::npos);
    EXPECT_NE(svg.find("3000 points"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Quality, RejectsInvalidInput) {
    PointSet set = independent(10);
    EXPECT_NE(error_of([&] { quality(set, {.bins = 0}); }).find("bins"), std::string::npos);
    EXPECT_NE(error_of([&] { quality(set, {.range = std::nanf("")}); }).find("range"), std::string::npos);
    set.positions[3].z = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(error_of([&] { quality(set); }).find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace coppice
