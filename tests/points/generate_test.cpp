#include "coppice/points/sampling/generate.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "coppice/points/quality.h"
#include "points/support.h"

namespace coppice {
namespace {

using namespace points_support;

const Ball kBall;
const FieldRef kField(kBall);

constexpr std::array kPatterns{PointPattern::poisson_disk, PointPattern::clustered, PointPattern::uniform,
                               PointPattern::jittered, PointPattern::blue_noise};
constexpr std::array kDensities{PointDensity::uniform, PointDensity::proportional, PointDensity::inverse,
                                PointDensity::inside_boundary, PointDensity::outside_boundary};

TEST(Generate, EveryPatternOfEveryDensityIsInsideItsRegion) {
    for (const PointPattern pattern : kPatterns) {
        for (const PointDensity density : kDensities) {
            SCOPED_TRACE(std::string(name_of(pattern)) + " " + std::string(name_of(density)));
            const auto result =
                generate(kField, ball_box(), {.pattern = pattern, .density = density, .count = 2000});
            if (pattern == PointPattern::jittered) {
                EXPECT_NEAR(static_cast<double>(result.points.size()), 2000, 160);
            } else {
                EXPECT_EQ(result.points.size(), 2000u);
            }
            EXPECT_EQ(result.stop, PointStop::count_reached);
            const float low = density == PointDensity::inside_boundary ? 0.9f : 0;
            const bool outside = density == PointDensity::outside_boundary;
            for (const Vec3 p : result.points.positions) {
                const float r = length(p);
                EXPECT_TRUE(outside ? r > 1 && r < 1.1001f : r < 1 && r >= low - 1e-4f) << r;
            }
            EXPECT_GE(min_distance(result.points), static_cast<double>(result.distance));
        }
    }
}

TEST(Generate, IsBitIdenticalForAnyNumberOfThreads) {
    for (const PointPattern pattern : kPatterns) {
        const GenerateOptions options{.pattern = pattern, .count = 3000, .seed = 9};
        const auto one = generate(kField, ball_box(), options, {.threads = 1}).points;
        EXPECT_EQ(generate(kField, ball_box(), options, {.threads = 2}).points, one);
        EXPECT_EQ(generate(kField, ball_box(), options, {.threads = 7}).points, one);
        GenerateOptions other = options;
        other.seed = 10;
        EXPECT_NE(generate(kField, ball_box(), other).points, one);
    }
}

TEST(Generate, UniformAndProportionalPatternsFollowTheirDensity) {
    // Shares of ten shells of equal volume of the ball; the density there is 1, or 2 - r.
    constexpr std::size_t kShells = 10;
    for (const PointPattern pattern : {PointPattern::uniform, PointPattern::jittered}) {
        for (const PointDensity density : {PointDensity::uniform, PointDensity::proportional}) {
            const auto points =
                generate(kField, ball_box(), {.pattern = pattern, .density = density, .count = 50000}).points;
            std::array<double, kShells> seen{}, expected{};
            for (const Vec3 p : points.positions) {
                ++seen[std::min(kShells - 1,
                                static_cast<std::size_t>(kShells * std::pow(length(Vec3d(p)), 3)))];
            }
            // Integral of 4 pi r^2 (2 - r), or of 4 pi r^2; up to a factor.
            const auto mass = [&](double r) {
                return density == PointDensity::uniform ? r * r * r / 3
                                                        : 2 * r * r * r / 3 - r * r * r * r / 4;
            };
            for (std::size_t s = 0; s < kShells; ++s) {
                const double r0 = std::cbrt(static_cast<double>(s) / kShells);
                const double r1 = std::cbrt(static_cast<double>(s + 1) / kShells);
                expected[s] = static_cast<double>(points.size()) * (mass(r1) - mass(r0)) / mass(1);
            }
            EXPECT_LT(chi_square(seen, expected), 27.9);  // 9 degrees of freedom, 0.1 %
        }
    }
}

/// Returns radii that divide the ball of the law into shells of equal shares.
std::vector<double> equal_shells(const DensityCurve& law, std::size_t shells) {
    constexpr int kSteps = 20000;
    constexpr double kFarthest = 1.2;
    std::vector<double> sum(kSteps + 1, 0);
    const auto radius = [&](int k) { return kFarthest * k / kSteps; };
    for (int k = 0; k < kSteps; ++k) {
        const double r = radius(k) + 0.5 * kFarthest / kSteps;
        const auto i = static_cast<std::size_t>(k);
        sum[i + 1] = sum[i] + r * r * law.at(static_cast<float>(2 - r));
    }
    std::vector<double> limits;
    for (std::size_t s = 1; s < shells; ++s) {
        const double share = sum.back() * static_cast<double>(s) / static_cast<double>(shells);
        limits.push_back(radius(static_cast<int>(std::ranges::lower_bound(sum, share) - sum.begin())));
    }
    return limits;
}

TEST(Generate, PatternsWithADistanceFollowTheirDensityWithinFivePercent) {
    constexpr std::size_t kShells = 10;
    constexpr int kCount = 12000;
    for (const PointDensity density : kDensities) {
        const bool has_power = density == PointDensity::proportional || density == PointDensity::inverse;
        const bool is_thin =
            density == PointDensity::inside_boundary || density == PointDensity::outside_boundary;
        for (const float power : {1.0f, 4.0f}) {
            for (const float spacing : {0.75f, 0.9f}) {
                // In a thin shell disks are at both boundaries, and at 0.9 the middle has no space for its
                // share.
                if ((power > 1 && !has_power) || (is_thin && spacing > 0.8f)) continue;
                SCOPED_TRACE(fmt::format("{} power {} spacing {}", name_of(density), power, spacing));
                const GenerateOptions options{
                    .density = density, .power = power, .count = kCount, .spacing = spacing};
                const auto limits =
                    equal_shells(DensityCurve(density, kField.level(), options.width, power), kShells);
                const auto result = generate(kField, ball_box(), options);
                ASSERT_EQ(result.points.size(), std::size_t{kCount});
                std::array<double, kShells> seen{};
                for (const Vec3 p : result.points.positions) {
                    const double r = length(Vec3d(p));
                    ++seen[static_cast<std::size_t>(std::ranges::upper_bound(limits, r) - limits.begin())];
                }
                for (const double n : seen) EXPECT_NEAR(n * kShells / kCount, 1, 0.05);
            }
        }
    }
}

TEST(Generate, GivenCurveSelectsValues) {
    const PointRegion region{kField, ball_box(), DensityCurve({{1.5f, 1}, {1.75f, 1}})};
    for (const PointPattern pattern : kPatterns) {
        const PointSet points = generate(region, {.pattern = pattern, .count = 500}).points;
        EXPECT_GT(points.size(), 400u);  // a jittered grid has about the requested number
        for (const Vec3 p : points.positions) {
            EXPECT_GE(length(p), 0.25f - 1e-5f);
            EXPECT_LE(length(p), 0.5f + 1e-5f);
        }
    }
}

TEST(Generate, PatternsHaveTheirDistancesAndSpectra) {
    const auto report = [](PointPattern pattern) {
        return quality(generate(kField, ball_box(), {.pattern = pattern, .count = 8000}).points);
    };
    const auto disk = report(PointPattern::poisson_disk), uniform = report(PointPattern::uniform);
    const auto blue = report(PointPattern::blue_noise), jittered = report(PointPattern::jittered);
    const auto clustered = report(PointPattern::clustered);
    EXPECT_GT(blue.min_distance, disk.min_distance);
    EXPECT_GT(disk.min_distance, 10 * uniform.min_distance);
    EXPECT_LT(blue.low_power, 0.3);
    EXPECT_LT(disk.low_power, 0.5);
    EXPECT_LT(jittered.low_power, 0.5);
    EXPECT_NEAR(uniform.low_power, 1, 0.35);
    EXPECT_GT(clustered.low_power, 2);
}

TEST(Generate, CountOfZeroFillsTheRegionWithTheGivenDistance) {
    const auto result = generate(kField, ball_box(), {.count = 0, .distance = 0.3f});
    EXPECT_EQ(result.stop, PointStop::full);
    EXPECT_EQ(result.distance, 0.3f);
    // Random packings of balls fill 0.36 to 0.39 of space; points near the surface have space beyond it.
    EXPECT_GT(result.points.size(), 100u);
    EXPECT_LT(result.points.size(), 200u);
}

TEST(Generate, RejectsInvalidInput) {
    const auto catch_message = [](const GenerateOptions& o) {
        return error_of([&] { generate(kField, ball_box(), o); });
    };
    const float nan = std::nanf("");
    EXPECT_NE(catch_message({.count = -1}).find("count"), std::string::npos);
    EXPECT_NE(catch_message({.count = 0}).find("distance above 0"), std::string::npos);
    EXPECT_NE(catch_message({.pattern = PointPattern::uniform, .count = 0}).find("count must be above 0"),
              std::string::npos);
    EXPECT_NE(catch_message({.width = nan}).find("width"), std::string::npos);
    EXPECT_NE(catch_message({.width = 0}).find("width"), std::string::npos);
    EXPECT_NE(catch_message({.power = -1}).find("power"), std::string::npos);
    EXPECT_NE(catch_message({.distance = nan}).find("distance"), std::string::npos);
    EXPECT_NE(catch_message({.spacing = 2}).find("spacing"), std::string::npos);
    EXPECT_NE(catch_message({.cluster_gain = 1e9f}).find("cluster_gain"), std::string::npos);
    EXPECT_NE(catch_message({.pattern = PointPattern::clustered, .distance = 1, .cluster_reach = 0.5f})
                  .find("cluster_reach"),
              std::string::npos);
    for (const PointPattern pattern : kPatterns) {
        EXPECT_NE(
            catch_message({.pattern = pattern, .count = 100000000, .max_memory = 100}).find("max_memory"),
            std::string::npos);
    }
    EXPECT_NE(error_of([] {
                  generate(kField, {{9, 9, 9}, {10, 10, 10}});
              }).find("density is 0"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice
