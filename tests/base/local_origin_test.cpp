#include "coppice/base/local_origin.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(LocalOrigin, IsZeroWithinEightDiagonals) {
    EXPECT_EQ(local_origin({7, 0, 0}, {8.25, 0, 0}, {7, 0, 0}), Vec3d());
    EXPECT_EQ(local_origin({-1, 0, 0}, {1, 0, 0}, {1, 0, 0}), Vec3d());
    EXPECT_NE(local_origin({8, 0, 0}, {9, 0, 0}, {8, 0, 0}), Vec3d());
}

TEST(LocalOrigin, OfOnePointIsZero) { EXPECT_EQ(local_origin({5, 6, 7}, {5, 6, 7}, {5, 6, 7}), Vec3d()); }

TEST(LocalOrigin, IsTheAnchorRoundedToAFractionOfTheDiagonal) {
    // 20 m across: multiples of 16 / 16 = 1 m. 3e-9 across: of 2^-29 / 16 = 2^-33.
    EXPECT_EQ(local_origin({456789.25, 0, 300}, {456789.25, 0, 320}, {456789.25, 0, 300.75}),
              Vec3d(456789, 0, 301));
    const Vec3d low{1e-3, 0, 0}, high{1e-3 + 3e-9, 0, 0};
    const Vec3d tiny = local_origin(low, high, low);
    EXPECT_NEAR(tiny.x, 1e-3, std::ldexp(1.0, -34));
    EXPECT_EQ(std::ldexp(tiny.x, 33), std::round(std::ldexp(tiny.x, 33)));
}

TEST(LocalOrigin, ScalesExactlyByPowersOfTwo) {
    const Vec3d low{1.1, -20.3, 5000.7}, high{2.9, -18.4, 5001.1}, anchor{1.3, -19.9, 5000.9};
    const Vec3d once = local_origin(low, high, anchor);
    for (int power = -60; power <= 60; ++power) {
        const double s = std::ldexp(1.0, power);
        EXPECT_EQ(local_origin(low * s, high * s, anchor * s), once * s) << power;
    }
}

}  // namespace
}  // namespace coppice
