#include "coppice/field/kernel/ball_kernel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/random.h"
#include "coppice/field/convolution_field.h"
#include "field/support.h"

namespace coppice {
namespace {

using kernel::SegmentConstants;

const KernelConstants kBalls = kernel_constants({.kernel = Kernel::balls});

SegmentConstants<double> along_x(double length, int balls, double radius = 1, double slope = 0) {
    return {0, 0, 0, 1, 0, 0, 0, length, length, radius, slope, 1, balls};
}

TEST(BallKernel, AddsWeightedBalls) {
    // Three balls at 0, 1 and 2; those at the ends have half weight; only the first ball reaches the second
    // point.
    const auto s = along_x(2, 2);
    const double w = 15 / (16 * std::pow(1.25, 2.5));
    const auto ball = [](double d2) { return std::pow(std::max(2.25 - d2, 0.0), 2); };
    EXPECT_NEAR(sample_segment(kBalls, s, {0.5, 0.8, 0}).value,
                w * (0.5 * ball(0.89) + ball(0.89) + 0.5 * ball(2.89)), 1e-12);
    EXPECT_NEAR(sample_segment(kBalls, s, {-0.7, 0, 1}).value, w * 0.5 * ball(1.49), 1e-12);
    EXPECT_EQ(sample_segment(kBalls, s, {-2, 0, 0}).value, 0);
    EXPECT_EQ(sample_segment(kBalls, along_x(2, 0), {1, 0, 0}).value, 0);
}

TEST(BallKernel, GradientMatchesFiniteDifferencesOnACone) {
    const CounterRandom random(8, 1);
    const auto s = along_x(3, 5, 1, -0.2);
    for (std::uint64_t i = 0; i < 100; ++i) {
        const Vec3d p{random.uniform(3 * i, -1, 4), random.uniform(3 * i + 1, -1, 1),
                      random.uniform(3 * i + 2, -1, 1)};
        const auto f = [&](Vec3d q) { return sample_segment(kBalls, s, {q.x, q.y, q.z}); };
        EXPECT_LT(test::gradient_error(f, p), 1e-5);
    }
}

TEST(BallKernel, ManyBallsConvergeToTheLineIntegral) {
    for (const double slope : {0.0, -0.1}) {
        auto s = along_x(4, 4000, 1, slope);
        const Vec3d p{1.7, 0.6, 0.3};
        const double line = sample_segment(test::quartic(1.5), s, {p.x, p.y, p.z}).value;
        // The line uses one radius, the one at the closest point.
        EXPECT_NEAR(sample_segment(kBalls, s, {p.x, p.y, p.z}).value, line, slope == 0 ? 1e-6 : 0.03);
    }
}

TEST(BallChain, SmallerSpacingIsAtLeastAsSmooth) {
    for (const double support : {1.5, 2.0}) {
        double wider = 0;
        for (const double bulge : {0.001, 0.01, 0.05, 0.3}) {
            const BallChain chain = ball_chain(support, bulge);
            EXPECT_GT(chain.spacing, wider);
            wider = chain.spacing;
            for (double spacing = 0.02; spacing <= chain.spacing; spacing += 0.02) {
                const BallChain closer = compute_ball_chain(support, spacing);
                EXPECT_LE(std::abs(closer.at_balls - closer.between), bulge + 1e-4) << spacing;
            }
        }
    }
}

TEST(BallChain, SwellingMatchesTheField) {
    // 1.6 radii apart: the surface swells by 0.08 at balls, and sinks by the same amount between them.
    const BallChain chain = compute_ball_chain(1.5, 1.6);
    EXPECT_NEAR(chain.at_balls, 1.082, 1e-3);
    EXPECT_NEAR(chain.between, 0.920, 1e-3);
    const auto s = along_x(1.6 * 20, 20);
    EXPECT_NEAR(sample_segment(kBalls, s, {1.6 * 10, chain.at_balls, 0}).value, 1, 1e-6);
    EXPECT_NEAR(sample_segment(kBalls, s, {1.6 * 10.5, chain.between, 0}).value, 1, 1e-6);
}

TEST(SegmentBuilder, SpacingOfBallsFollowsTheThinEnd) {
    const SegmentBuilder builder({.kernel = Kernel::balls, .ball_bulge = 0.02f});
    const double spacing = builder.chain().spacing;
    const auto count = [&](float length, float a, float b) {
        return builder.build({{0, 0, 0}, {length, 0, 0}, a, b}, {0, 0, 1}, false, RootEnd::none).balls;
    };
    EXPECT_EQ(count(10, 1, 1), static_cast<int>(std::ceil(10 / spacing)));
    EXPECT_EQ(count(10, 1, 0.5f), static_cast<int>(std::ceil(20 / spacing)));
    EXPECT_EQ(count(0.1f, 1, 1), 1);
    EXPECT_EQ(count(0, 1, 1), 0);
    // Not hundreds of thousands for a very thin branch at a ball.
    EXPECT_EQ(count(10, 1, 1e-5f), static_cast<int>(std::ceil(320 / spacing)));
    EXPECT_LE(count(1e9f, 1, 1), 1 << 20);
    EXPECT_EQ(SegmentBuilder({}).build({{0, 0, 0}, {9, 0, 0}, 1, 1}, {0, 0, 1}, true, RootEnd::base).balls,
              0);
}

}  // namespace
}  // namespace coppice
