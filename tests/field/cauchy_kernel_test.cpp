#include "coppice/field/kernel/cauchy_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coppice/base/random.h"
#include "field/support.h"

namespace coppice {
namespace {

using kernel::CauchyKernel;

CauchyKernel<double> cauchy_kernel(double width) { return {width, CauchyKernel<double>::line_weight(width)}; }

TEST(CauchyKernel, MatchesTheIntegralOfItsDefinition) {
    const CounterRandom random(2, 1);
    for (std::uint64_t i = 0; i < 400; ++i) {
        const double k = random.uniform(5 * i, 0.5, 8), h2 = random.uniform(5 * i + 1, 0, 9);
        const double x0 = random.uniform(5 * i + 2, -6, 6), x1 = x0 + random.uniform(5 * i + 3, 0, 8);
        // Zhu2015, eq. 3 for iso value 1 and radius 1.
        const double lambda = 2 / std::numbers::pi * k * std::pow(1 + k * k, 1.5);
        const auto f = [&](double x) { return std::pow(1 + k * k * (h2 + x * x), -2); };
        const double expected = lambda * test::integrate(f, x0, x1, 400);
        EXPECT_NEAR(cauchy_kernel(k)(h2, x0, x1).value, expected, 1e-9 * (1 + expected));
    }
}

TEST(CauchyKernel, InfiniteLineHasTheIsoValueAtItsRadius) {
    for (const double k : {0.5, 1.0, 2.0, 3.0, 8.0})
        EXPECT_NEAR(cauchy_kernel(k)(1, -1e5, 1e5).value, 1, 1e-12);
}

TEST(CauchyKernel, DerivativesMatchFiniteDifferences) {
    const CounterRandom random(2, 2);
    for (std::uint64_t i = 0; i < 200; ++i) {
        const auto f = cauchy_kernel(random.uniform(5 * i, 0.5, 4));
        const double h2 = random.uniform(5 * i + 1, 0.01, 4);
        const double x0 = random.uniform(5 * i + 2, -4, 4), x1 = x0 + random.uniform(5 * i + 3, 0, 5);
        test::expect_derivatives_match(f, h2, x0, x1);
    }
}

}  // namespace
}  // namespace coppice
