#include "coppice/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <set>

namespace coppice {
namespace {

TEST(MixBits, MatchesSplitMix64) {
    // SplitMix64 from seed 0 adds 0x9e3779b97f4a7c15 before every draw, as mix_bits does once: its first
    // three draws, as the authors' program prints them.
    constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15ull;
    EXPECT_EQ(mix_bits(0), 0xe220a8397b1dcdafull);
    EXPECT_EQ(mix_bits(kStep), 0x6e789e6aa1b965f4ull);
    EXPECT_EQ(mix_bits(2 * kStep), 0x06c45d188009454full);
}

TEST(MixBits, EveryInputBitChangesHalfOfTheOutputBits) {
    constexpr int kDraws = 1000;
    for (int bit = 0; bit < 64; ++bit) {
        int changed = 0;
        for (std::uint64_t i = 0; i < kDraws; ++i)
            changed += std::popcount(mix_bits(i) ^ mix_bits(i ^ (std::uint64_t{1} << bit)));
        // 64 bits are like coin tosses: mean 32, deviation 4; the mean of 1000 draws has 0.13; five of those.
        EXPECT_NEAR(static_cast<double>(changed) / kDraws, 32, 0.65) << bit;
    }
}

TEST(CounterRandom, DependsOnSeedStageAndIndexOnly) {
    const CounterRandom random(5, 2);
    const std::uint64_t ninth = random.bits(9);
    for (std::uint64_t i = 0; i < 9; ++i) random.bits(i);
    EXPECT_EQ(random.bits(9), ninth);
    EXPECT_EQ(CounterRandom(5, 2).bits(9), ninth);
    EXPECT_NE(CounterRandom(6, 2).bits(9), ninth);
    EXPECT_NE(CounterRandom(5, 3).bits(9), ninth);
    EXPECT_NE(CounterRandom(2, 5).bits(9), ninth);  // seed and stage are not interchangeable
}

TEST(CounterRandom, AdjacentSeedsAndStagesShareNoDraws) {
    // 64 streams of 64 draws: among 4096 draws of 64 bits, two are equal once in 2 * 10^12 times.
    std::set<std::uint64_t> draws;
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        for (std::uint64_t stage = 0; stage < 8; ++stage) {
            const CounterRandom random(seed, stage);
            for (std::uint64_t i = 0; i < 64; ++i) draws.insert(random.bits(i));
        }
    }
    EXPECT_EQ(draws.size(), 4096u);
}

TEST(CounterRandom, UniformNumbersAreEvenlyDistributed) {
    constexpr int kDraws = 100'000, kBins = 100;
    const CounterRandom random(1, 1);
    std::array<int, kBins> bins{};
    double sum = 0;
    for (std::uint64_t i = 0; i < kDraws; ++i) {
        const double u = random.uniform(i);
        ASSERT_TRUE(u >= 0 && u < 1) << u;
        ++bins[static_cast<std::size_t>(u * kBins)];
        sum += u;
    }
    // Mean 1/2, deviation 1/sqrt(12 * 10^5) = 0.00091; five of those.
    EXPECT_NEAR(sum / kDraws, 0.5, 0.0046);
    // Chi squared of 99 degrees of freedom: mean 99, deviation sqrt(198) = 14; five of those either way.
    double chi = 0;
    for (const int n : bins) chi += (n - 1000.0) * (n - 1000.0) / 1000.0;
    EXPECT_NEAR(chi, 99, 70);
}

TEST(CounterRandom, AdjacentDrawsAreIndependent) {
    constexpr int kDraws = 100'000;
    const CounterRandom random(1, 1), other(1, 2);
    double next = 0, stage = 0;
    for (std::uint64_t i = 0; i < kDraws; ++i) {
        const double u = random.uniform(i) - 0.5;
        next += u * (random.uniform(i + 1) - 0.5);
        stage += u * (other.uniform(i) - 0.5);
    }
    // A product of two independent draws about 0 has deviation 1/12; the mean of 10^5 has 0.00026; five of
    // those.
    EXPECT_NEAR(next / kDraws, 0, 0.0013);
    EXPECT_NEAR(stage / kDraws, 0, 0.0013);
}

TEST(CounterRandom, RangeIsTheScaledUnitRange) {
    const CounterRandom random(3, 4);
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const double u = random.uniform(i, -2, 6);
        EXPECT_TRUE(u >= -2 && u < 6) << u;
        EXPECT_EQ(u,
                  -2 + 8 * random.uniform(i));  // exact: 8 is a power of two, so there is only one rounding
    }
}

}  // namespace
}  // namespace coppice
