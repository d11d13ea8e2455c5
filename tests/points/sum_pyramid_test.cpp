#include "coppice/points/sampling/sum_pyramid_internal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/random.h"

namespace coppice {
namespace {

Buffer<double> weights(std::size_t n) {
    Buffer<double> w(n);
    const CounterRandom random(5, 0);
    for (std::size_t i = 0; i < n; ++i) w[i] = random.uniform(2 * i) < 0.3 ? 0 : random.uniform(2 * i + 1);
    return w;
}

TEST(SumPyramid, FindsTheItemOfEachFraction) {
    for (const std::size_t n : {1u, 7u, 8u, 9u, 64u, 65u, 1000u}) {
        Buffer<double> w = weights(n);
        w[n / 2] = 1;
        const SumPyramid pyramid(w, {});
        double sum = 0;
        for (const double x : w) sum += x;
        EXPECT_NEAR(pyramid.total(), sum, 1e-9);
        double before = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
            if (w[i] > 1e-6) {
                EXPECT_EQ(pyramid.find((before + 0.5 * w[i]) / sum), i);
            }
            before += w[i];
        }
    }
}

TEST(SumPyramid, NeverFindsAnItemOfWeightZero) {
    Buffer<double> w(100, 0.0);
    w[37] = 1e-300;
    w[41] = 1;
    const SumPyramid pyramid(w, {});
    EXPECT_EQ(pyramid.find(0), 37u);
    EXPECT_EQ(pyramid.find(std::nextafter(1.0, 0.0)), 41u);
    w[41] = 0;
    EXPECT_EQ(SumPyramid(w, {}).find(std::nextafter(1.0, 0.0)), 37u);
}

TEST(SumPyramid, UpdateMatchesANewPyramid) {
    Buffer<double> w = weights(3000);
    SumPyramid pyramid(w, {});
    std::vector<std::uint32_t> changed{5, 5, 6, 2999, 17, 16, 512, 2048};
    for (const std::uint32_t i : changed) pyramid.set(i, w[i] = 0.25 * i);
    pyramid.update(changed);
    const SumPyramid anew(w, {});
    EXPECT_EQ(pyramid.total(), anew.total());
    for (int k = 0; k < 1000; ++k) EXPECT_EQ(pyramid.find(k / 1000.0), anew.find(k / 1000.0));
}

TEST(SumPyramid, EmptyHasTotalZero) { EXPECT_EQ(SumPyramid(Buffer<double>{}, {}).total(), 0); }

}  // namespace
}  // namespace coppice
