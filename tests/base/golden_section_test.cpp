#include "coppice/base/golden_section.h"

#include <gtest/gtest.h>

#include <cmath>

namespace coppice {
namespace {

TEST(GoldenSection, FindsMinimaInsideAndAtTheEnds) {
    const auto distance_from = [](double place) { return [=](double x) { return std::abs(x - place); }; };
    EXPECT_NEAR(find_minimum(-1.0, 4.0, 1e-9, distance_from(0.7)), 0.7, 1e-9);
    EXPECT_NEAR(find_minimum(-1.0, 4.0, 1e-9, distance_from(-3.0)), -1.0, 1e-9);
    EXPECT_NEAR(find_minimum(-1.0, 4.0, 1e-9, distance_from(5.0)), 4.0, 1e-9);
}

TEST(GoldenSection, NeedsFewEvaluations) {
    int evaluations = 0;
    const double x = find_minimum(0.0, 1.0, 1e-6, [&](double t) {
        ++evaluations;
        return (t - 0.3) * (t - 0.3);
    });
    EXPECT_NEAR(x, 0.3, 1e-6);
    EXPECT_LE(evaluations, 32);
}

}  // namespace
}  // namespace coppice
