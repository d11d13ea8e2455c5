#include "coppice/ramification/objective_internal.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace coppice {
namespace {

constexpr double kPi = std::numbers::pi;

/// Returns a regular loop about a position, starting at an angle.
template <std::size_t kCount>
std::array<Vec3d, kCount> loop(Vec3d center, double radius, double from) {
    std::array<Vec3d, kCount> out;
    for (std::size_t k = 0; k < kCount; ++k) {
        const double a = from + 2 * kPi * static_cast<double>(k) / kCount;
        out[k] = center + Vec3d{std::cos(a), std::sin(a), 0} * radius;
    }
    return out;
}

TEST(Objective, CosineDistanceIsZeroForEqualAndTwoForOppositeDirections) {
    EXPECT_DOUBLE_EQ(cosine_distance({2, 0, 0}, {5, 0, 0}), 0);
    EXPECT_DOUBLE_EQ(cosine_distance({2, 0, 0}, {0, 3, 0}), 1);
    EXPECT_DOUBLE_EQ(cosine_distance({2, 0, 0}, {-1, 0, 0}), 2);
    EXPECT_EQ(cosine_distance({}, {1, 0, 0}), 0);
}

TEST(Objective, CubesAreNotDistorted) {
    EXPECT_NEAR(unit_distortion(1, 1, 1), 0, 1e-15);
    // An end at the centre moves the corner onto the side: 45 degrees from the diagonal, for two corners.
    EXPECT_NEAR(unit_distortion(1, 0, 1), 2 * (1 - std::sqrt(0.5)), 1e-15);
    EXPECT_GT(unit_distortion(1, 0.4, 1), unit_distortion(1, 0.6, 1));
}

TEST(Objective, ConnectionsRepelBelowOneDiameter) {
    EXPECT_DOUBLE_EQ(connection_distortion(0, 3, 2), 0);
    EXPECT_DOUBLE_EQ(connection_distortion(0, 0, 2), 4);
    EXPECT_GT(connection_distortion(0, -1, 2), 4);
    // Four corners rotated by an eighth of a turn.
    EXPECT_NEAR(connection_distortion(kPi / 4, 3, 2), 4 * (1 - std::sqrt(0.5)), 1e-15);
}

TEST(Objective, BestTurnRevertsAShiftOfTheIndices) {
    const auto first = loop<8>({0, 0, 0}, 1, 0.1);
    for (std::uint32_t shift = 0; shift < 8; ++shift) {
        auto second = loop<8>({3, 1, 2}, 0.5, 0.2);
        std::array<Vec3d, 8> shifted;
        for (std::uint32_t k = 0; k < 8; ++k) shifted[(k + shift) % 8] = second[k];
        EXPECT_EQ(best_turn(first, shifted, {0, 0, 1}), shift);
    }
}

TEST(Objective, PastesWeightDirectionsAndLengthsEqually) {
    const auto place = loop<8>({0, 0, 0}, 1, 0);
    EXPECT_NEAR(paste_distortion(place, place, 2), 0, 1e-15);
    // Eight lengths of 1, divided by the diameter 2, with weight 0.5; the directions from the centres are
    // equal.
    EXPECT_NEAR(paste_distortion(loop<8>({0, 0, 1}, 1, 0), place, 2), 0.5 * 8 / 2, 1e-12);
    // A quarter of a turn: eight cosine distances of 1, and eight lengths of sqrt 2.
    EXPECT_NEAR(paste_distortion(loop<8>({0, 0, 0}, 1, kPi / 2), place, 2),
                0.5 * 8 + 0.5 * 8 * std::numbers::sqrt2 / 2, 1e-12);
}

}  // namespace
}  // namespace coppice
