#include "coppice/base/kernel/fast_atan2.h"

#include <gtest/gtest.h>

#include <numbers>

namespace coppice {
namespace {

TEST(FastAtan2, IsCloseToTheExactAngleInAllDirections) {
    constexpr int kSteps = 200000;
    for (const double length : {1e-30, 1.0, 1e30}) {
        double worst = 0;
        for (int i = 0; i <= kSteps; ++i) {
            const double angle = (2.0 * i / kSteps - 1) * std::numbers::pi;
            const auto y = static_cast<float>(length * std::sin(angle)),
                       x = static_cast<float>(length * std::cos(angle));
            worst = std::max(worst, std::abs(fast_atan2(y, x) - std::atan2(double{y}, double{x})));
        }
        EXPECT_LT(worst, 4e-7) << length;
    }
}

TEST(FastAtan2, IsExactOnAxesAndAtTheOrigin) {
    EXPECT_EQ(fast_atan2(0, 1), 0);
    EXPECT_FLOAT_EQ(fast_atan2(1, 0), std::numbers::pi_v<float> / 2);
    EXPECT_FLOAT_EQ(fast_atan2(0, -1), std::numbers::pi_v<float>);
    EXPECT_FLOAT_EQ(fast_atan2(-1, 0), -std::numbers::pi_v<float> / 2);
    EXPECT_EQ(fast_atan2(0, 0), 0);
}

}  // namespace
}  // namespace coppice
