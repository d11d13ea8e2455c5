#include "coppice/edit/animate/easing.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(Easing, IncreasesFromZeroToOne) {
    for (const Easing e : {Easing::smooth, Easing::linear, Easing::in, Easing::out, Easing::hold}) {
        SCOPED_TRACE(name_of(e));
        EXPECT_EQ(eased(e, 0), 0);
        EXPECT_EQ(eased(e, 1), 1);
        for (int i = 0; i < 100; ++i) EXPECT_LE(eased(e, i / 100.0), eased(e, (i + 1) / 100.0));
    }
}

TEST(Easing, HasTheEndSpeedsOfItsName) {
    constexpr double kStep = 1e-4;
    const auto speed_at_start = [](Easing e) { return eased(e, kStep) / kStep; };
    const auto speed_at_end = [](Easing e) { return (1 - eased(e, 1 - kStep)) / kStep; };
    EXPECT_LT(speed_at_start(Easing::smooth), 0.01);
    EXPECT_LT(speed_at_end(Easing::smooth), 0.01);
    EXPECT_LT(speed_at_start(Easing::in), 0.01);
    EXPECT_GT(speed_at_end(Easing::in), 1.5);
    EXPECT_LT(speed_at_end(Easing::out), 0.01);
    EXPECT_EQ(eased(Easing::hold, 0.999), 0);
}

}  // namespace
}  // namespace coppice
