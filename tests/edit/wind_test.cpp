#include "coppice/edit/animate/wind.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/error.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice {
namespace {

constexpr double kPeriod = 8;

Skeleton pole(double x, float radius = 0.05f) {
    std::vector<NodeId> parent{NodeId::none()};
    std::vector<Vec3> position{Vec3(Vec3d{x, 0, 0})};
    for (std::uint32_t i = 1; i <= 10; ++i) {
        parent.emplace_back(i - 1);
        position.push_back(Vec3(Vec3d{x, 0, 0.6 * i}));
    }
    return {parent, position, std::vector<float>(11, radius)};
}

double lean_at(const Skeleton& s, const WindOptions& options, double time) {
    const Pose p = Wind(s, options, kPeriod, 20).swayed(rest_pose(s), time);
    return double{p.positions.back().x - s.positions().back().x};
}

double mean_lean(const Skeleton& s, const WindOptions& options) {
    double sum = 0;
    for (int i = 0; i < 80; ++i) sum += lean_at(s, options, kPeriod * i / 80) / 80;
    return sum;
}

TEST(Wind, OfSpeedZeroMovesNothing) {
    const Skeleton s = random_tree(100, 1);
    const Pose rest = rest_pose(s);
    const Pose now = Wind(s, {.speed = 0}, kPeriod, 20).swayed(rest, 1.3);
    EXPECT_EQ(now.positions, rest.positions);
}

TEST(Wind, PreservesLengthsAndRoots) {
    const Skeleton s = random_tree(300, 2);
    const Pose now = Wind(s, {.speed = 20, .flexibility = 10}, kPeriod, 20).swayed(rest_pose(s), 3);
    for (const NodeId n : nodes(s)) {
        const std::uint32_t i = n.index();
        if (s.is_root(n)) {
            EXPECT_EQ(now.positions[i], s.position(n));
            continue;
        }
        const std::uint32_t p = s.parent(n).index();
        const float before = distance(s.positions()[i], s.positions()[p]);
        EXPECT_NEAR(distance(now.positions[i], now.positions[p]), before, 1e-4f * (1 + before));
    }
}

TEST(Wind, IsPeriodic) {
    const Skeleton s = random_tree(100, 3);
    const Wind wind(s, {.speed = 15, .flexibility = 10}, kPeriod, 20);
    const Pose a = wind.swayed(rest_pose(s), 1.7), b = wind.swayed(rest_pose(s), 1.7 + kPeriod);
    for (std::size_t i = 0; i < a.positions.size(); ++i)
        EXPECT_LT(distance(a.positions[i], b.positions[i]), 1e-5f);
}

TEST(Wind, BendsMoreForThinPolesAndStrongWinds) {
    const double usual = mean_lean(pole(0), {.speed = 10});
    EXPECT_GT(usual, 0);
    EXPECT_GT(mean_lean(pole(0, 0.03f), {.speed = 10}), 2 * usual);
    EXPECT_GT(mean_lean(pole(0), {.speed = 14}), 1.5 * usual);
    EXPECT_LT(mean_lean(pole(0), {.speed = 10, .azimuth = 3.14159f}), 0);
}

TEST(Wind, GustsAreDelayedDownwind) {
    // Stiff thick poles follow only the gusts: 12 m downwind the sway is the same, delayed by the travel
    // time.
    const WindOptions options{.speed = 6, .gusts = 1, .flexibility = 3};
    const Skeleton s({NodeId::none(), NodeId(0), NodeId::none(), NodeId(2)},
                     {{0, 0, 0}, {0, 0, 4}, {12, 0, 0}, {12, 0, 4}}, std::vector<float>(4, 0.02f));
    const Wind wind(s, options, kPeriod, 1);
    double same = 0, late = 0;
    for (int i = 0; i < 64; ++i) {
        const double time = kPeriod * i / 64;
        const auto lean = [&](std::size_t n, double t) {
            const Pose p = wind.swayed(rest_pose(s), t);
            return double{p.positions[n].x - s.positions()[n].x};
        };
        same += std::abs(lean(3, time) - lean(1, time));
        late += std::abs(lean(3, time + 2) - lean(1, time));
    }
    EXPECT_LT(late, same);
}

TEST(Wind, RejectsOptionsOutOfRange) {
    EXPECT_THROW(Wind(pole(0), {.speed = -1}, kPeriod, 20), InvalidInput);
    EXPECT_THROW(Wind(pole(0), {}, 0, 20), InvalidInput);
}

}  // namespace
}  // namespace coppice
