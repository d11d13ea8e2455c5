#include "coppice/field/kernel/segment_kernel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/random.h"
#include "field/support.h"

namespace coppice {
namespace {

using test::DoubleField;

const KernelConstants kNormalForms[] = {test::quartic(1.5), test::quartic(2), test::cauchy(2)};

TEST(SegmentKernel, LongConeHasTheIsoValueAtItsLocalRadius) {
    for (const auto& k : kNormalForms) {
        // At least 45 radii from both ends.
        const auto f = DoubleField(k).add({0, 0, 0}, {0, 0, 1000}, 11, 1);
        for (const double z : {500.0, 600.0, 700.0}) EXPECT_NEAR(f.value({11 - z / 100, 0, z}), 1, 1e-5);
    }
}

TEST(SegmentKernel, GradientIncludesTheSlopeOfTheRadius) {
    const CounterRandom random(4, 1);
    for (const auto& k : kNormalForms) {
        for (std::uint64_t i = 0; i < 100; ++i) {
            const auto draw = [&](std::uint64_t j, double low, double high) {
                return random.uniform(9 * i + j, low, high);
            };
            const Vec3d a{draw(0, -1, 1), draw(1, -1, 1), draw(2, -1, 1)};
            const Vec3d b = a + Vec3d{draw(3, 0.2, 2), draw(4, -1, 1), draw(5, -1, 1)};
            const auto f = DoubleField(k).add(a, b, draw(6, 0.5, 1.5), draw(7, 0.5, 1.5));
            const Vec3d p = lerp(a, b, draw(8, -0.5, 1.5)) + Vec3d{0.1, 0.4, -0.3};
            EXPECT_LT(test::gradient_error([&](Vec3d q) { return f.sample(q); }, p), 1e-5);
        }
    }
}

TEST(SegmentKernel, SplittingACylinderChangesNothing) {
    for (const auto& k : {test::quartic(1.5), test::cauchy(2), test::scalis()}) {
        const auto whole = DoubleField(k).add({0, 0, 0}, {0.8, 0, 0});
        DoubleField pieces(k);
        for (int i = 0; i < 16; ++i) pieces.add({i * 0.05, 0, 0}, {(i + 1) * 0.05, 0, 0});
        for (const Vec3d p : {Vec3d{0.4, 0.7, 0}, {1.2, 0.3, 0.1}, {-0.7, 0, 0.2}, {0.4, 0, 0}}) {
            EXPECT_NEAR(pieces.value(p), whole.value(p), 1e-12);
        }
    }
}

TEST(SegmentKernel, SplittingAConeOfSlope5PercentMovesTheSurfaceByLessThan1Percent) {
    for (const auto& k : {test::quartic(1.5), test::cauchy(2)}) {
        DoubleField pieces(k);
        for (int i = 0; i < 160; ++i) {
            pieces.add({i * 0.05, 0, 0}, {(i + 1) * 0.05, 0, 0}, 1 - i * 0.0025, 1 - (i + 1) * 0.0025);
        }
        for (const double x : {3.5, 3.525, 4.0}) {
            const double radius = 1 - 0.05 * x;
            EXPECT_NEAR(pieces.reach({x, 0, 0}, {0, 1, 0}) / radius, 1, 0.01);
        }
    }
}

}  // namespace
}  // namespace coppice
