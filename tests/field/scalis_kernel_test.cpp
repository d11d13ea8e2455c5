#include "coppice/field/kernel/scalis_kernel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/random.h"
#include "field/support.h"

namespace coppice {
namespace {

using Constants = kernel::SegmentConstants<double>;

Constants along_x(double length, double radius, double slope) {
    return {0, 0, 0, 1, 0, 0, 0, length, length, radius, slope, 1};
}

/// The definition; with many sections, because the integrand has kinks where the support ends.
double by_quadrature(const Constants& s, Vec3d p) {
    const auto f = [&](double x) {
        const double tau = s.radius + s.slope * x;
        const double k = 1 - length_squared(p - Vec3d(x, 0, 0)) / (4 * tau * tau);
        return k > 0 ? k * k * k / tau : 0;
    };
    return test::integrate(f, 0, s.length, 3000) / (32.0 / 35 * std::pow(3, 3.5) / 64);
}

double worst_error(double slope, std::uint64_t stage) {
    const CounterRandom random(3, stage);
    double worst = 0;
    for (std::uint64_t i = 0; i < 100; ++i) {
        const Constants s =
            along_x(random.uniform(4 * i, 0.2, 5), 1, random.uniform(4 * i + 1, -slope, slope));
        const double x = random.uniform(4 * i + 2, -1, s.length + 1);
        const Vec3d p{x, random.uniform(4 * i + 3, 0.3, 2) * (s.radius + s.slope * x), 0};
        const double value = sample_segment(test::scalis(), s, {p.x, p.y, p.z}).value;
        worst = std::max(worst, std::abs(value - by_quadrature(s, p)));
    }
    return worst;
}

TEST(ScalisKernel, MatchesTheIntegralOfItsDefinition) {
    EXPECT_LT(worst_error(0, 1), 1e-9);
    EXPECT_LT(worst_error(0.03, 2), 2e-5);
    EXPECT_LT(worst_error(0.06, 3), 2e-4);
    EXPECT_LT(worst_error(0.15, 4), 3e-3);
}

TEST(ScalisKernel, CylinderHasTheIsoValueAtItsRadius) {
    for (const double radius : {1e-3, 1.0, 50.0}) {
        const auto f =
            sample_segment(test::scalis(), along_x(20 * radius, radius, 0), {10 * radius, 0, radius});
        EXPECT_NEAR(f.value, 1, 1e-12);
    }
}

TEST(ScalisKernel, GradientMatchesFiniteDifferences) {
    const CounterRandom random(3, 5);
    for (std::uint64_t i = 0; i < 100; ++i) {
        const Constants s = along_x(random.uniform(4 * i, 0.5, 5), 1, random.uniform(4 * i + 1, -0.05, 0.05));
        const Vec3d p{random.uniform(4 * i + 2, -0.5, s.length + 0.5), random.uniform(4 * i + 3, 0.3, 1.6),
                      0.2};
        const auto f = [&](Vec3d q) { return sample_segment(test::scalis(), s, {q.x, q.y, q.z}); };
        EXPECT_LT(test::gradient_error(f, p), 2e-4);
    }
}

TEST(ScalisKernel, IsFiniteForSteepConesAndFarPoints) {
    for (const double slope : {-0.4, 0.4}) {
        const Constants s = along_x(2, 1, slope);
        for (const double x : {-1e6, -10.0, -2.5, 0.0, 1.0, 2.0, 2.5, 7.5, 1e6}) {
            for (const double y : {0.0, 1.0, 1e6}) {
                const auto f = sample_segment(test::scalis(), s, {x, y, 0});
                EXPECT_TRUE(std::isfinite(f.value) && std::isfinite(f.gx) && std::isfinite(f.gy))
                    << x << ' ' << y;
                EXPECT_GE(f.value, 0);
            }
        }
    }
}

}  // namespace
}  // namespace coppice
