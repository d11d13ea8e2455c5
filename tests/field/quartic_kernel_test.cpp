#include "coppice/field/kernel/quartic_kernel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/random.h"
#include "field/support.h"

namespace coppice {
namespace {

using kernel::QuarticKernel;

QuarticKernel<double> quartic_kernel(double support) {
    return {support, QuarticKernel<double>::line_weight(support)};
}

/// The definition: Zhu2015's weight for iso value 1 and radius 1 times the integral of (1 - r^2/R^2)^2 inside
/// R.
double by_quadrature(double support, double h2, double x0, double x1) {
    const double r2 = support * support;
    if (h2 >= r2) return 0;
    const double b = std::sqrt(r2 - h2);
    const double lambda = 15 * r2 * r2 / (16 * std::pow(r2 - 1, 2.5));
    const auto f = [&](double x) { return std::pow(1 - (h2 + x * x) / r2, 2); };
    return lambda * test::integrate(f, std::clamp(x0, -b, b), std::clamp(x1, -b, b), 10);
}

TEST(QuarticKernel, MatchesTheIntegralOfItsDefinition) {
    const CounterRandom random(1, 1);
    for (std::uint64_t i = 0; i < 400; ++i) {
        const double support = random.uniform(5 * i, 1.1, 4);
        const double h2 = random.uniform(5 * i + 1, 0, 1.2 * support * support);
        const double x0 = random.uniform(5 * i + 2, -5, 5), x1 = x0 + random.uniform(5 * i + 3, 0, 8);
        EXPECT_NEAR(quartic_kernel(support)(h2, x0, x1).value, by_quadrature(support, h2, x0, x1), 1e-9);
    }
}

TEST(QuarticKernel, InfiniteLineHasTheIsoValueAtItsRadius) {
    for (const double support : {1.1, 1.5, 2.0, 3.0, 4.0}) {
        EXPECT_NEAR(quartic_kernel(support)(1, -100, 100).value, 1, 1e-12);
    }
}

TEST(QuarticKernel, DerivativesMatchFiniteDifferences) {
    const CounterRandom random(1, 2);
    for (std::uint64_t i = 0; i < 200; ++i) {
        const auto f = quartic_kernel(random.uniform(5 * i, 1.3, 4));
        const double h2 = random.uniform(5 * i + 1, 0.01, 2);
        const double x0 = random.uniform(5 * i + 2, -3, 3), x1 = x0 + random.uniform(5 * i + 3, 0, 3);
        test::expect_derivatives_match(f, h2, x0, x1);
    }
}

TEST(QuarticKernel, IsZeroBeyondItsSupport) {
    const auto f = quartic_kernel(1.5);
    for (const auto& [h2, x0, x1] : {std::array{2.26, -1.0, 1.0}, {0.5, 1.5, 9.0}, {0.5, -9.0, -1.5}}) {
        const auto n = f(h2, x0, x1);
        EXPECT_EQ(n.value, 0);
        EXPECT_EQ(n.d_h2, 0);
    }
}

}  // namespace
}  // namespace coppice
