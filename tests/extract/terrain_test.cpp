#include "coppice/extract/plot/terrain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "extract/cloud_support.h"

namespace coppice {
namespace {

/// Returns the height of a slope of 20 degrees with hummocks of half a metre.
double hill(double x, double y) { return 0.36 * x + 0.5 * std::sin(0.6 * x) * std::cos(0.5 * y + 1); }

/// Returns 20 by 20 m of ground with trees on it: stems, and crowns with gaps above a third of the plan.
PointSet wood(bool with_ground) {
    PointSet set;
    const CounterRandom random(4, 2);
    std::uint64_t draw = 0;
    const auto next = [&](double low, double high) { return random.uniform(draw++, low, high); };
    for (int i = 0; i < 60000 && with_ground; ++i) {
        const double x = next(0, 20), y = next(0, 20);
        if (std::hypot(x - 9, y - 12) < 2) continue;  // occluded
        set.positions.push_back(Vec3(Vec3d{x, y, hill(x, y) + next(-0.02, 0.02)}));
    }
    for (int t = 0; t < 9; ++t) {
        const int row = t / 3;
        const double x = 3 + 7.0 * (t % 3), y = 3 + 7.0 * row, z = hill(x, y);
        strew_cone(set, {x, y, z}, {x, y, z + 8}, 0.15, 0.1, 2000, 0, false,
                   static_cast<std::uint64_t>(t) + 1);
        for (int i = 0; i < 6000; ++i) {
            const Vec3d p{next(-1, 1), next(-1, 1), next(-1, 1)};
            if (length(p) < 1) set.positions.push_back(Vec3(Vec3d{x, y, z + 6} + p * 3.0));
        }
    }
    return set;
}

TEST(Terrain, FollowsSlopesAndMoundsBelowTrees) {
    const Terrain terrain = find_terrain(wood(true).positions);
    EXPECT_TRUE(terrain.is_ground);
    EXPECT_GT(terrain.share, 0.9);
    double worst = 0, worst_hidden = 0;
    for (double x = 0.5; x < 20; x += 0.5) {
        for (double y = 0.5; y < 20; y += 0.5) {
            const double off = std::abs(terrain.height(x, y) - hill(x, y));
            (std::hypot(x - 9, y - 12) < 2.5 ? worst_hidden : worst) =
                std::max(std::hypot(x - 9, y - 12) < 2.5 ? worst_hidden : worst, off);
        }
    }
    EXPECT_LT(worst, 0.15);
    EXPECT_LT(worst_hidden, 0.5);
    EXPECT_LT(terrain.clearance, 0.26);
}

TEST(Terrain, IgnoresOutliersBelowTheGround) {
    PointSet set = wood(true);
    for (int i = 0; i < 30; ++i) {
        const double x = 0.6 * i + 1, y = 19 - 0.5 * i;
        set.positions.push_back(Vec3(Vec3d{x, y, hill(x, y) - 3}));
    }
    const Terrain terrain = find_terrain(set.positions);
    EXPECT_TRUE(terrain.is_ground);
    for (int i = 0; i < 30; ++i) {
        const double x = 0.6 * i + 1, y = 19 - 0.5 * i;
        EXPECT_NEAR(terrain.height(x, y), hill(x, y), 0.3) << i;
    }
}

TEST(Terrain, OutliersFarAwayDoNotReduceItsResolution) {
    PointSet set = wood(true);
    for (int i = 0; i < 5; ++i) set.positions.push_back({-2000.0f * static_cast<float>(i + 1), 3000, 50});
    const Terrain terrain = find_terrain(set.positions);
    EXPECT_TRUE(terrain.is_ground);
    for (double x = 0.5; x < 20; x += 1) EXPECT_NEAR(terrain.height(x, 5), hill(x, 5), 0.15) << x;
}

TEST(Terrain, HasNoGroundIfThereAreOnlyTrees) {
    EXPECT_FALSE(find_terrain(wood(false).positions).is_ground);
    EXPECT_FALSE(find_terrain(fork_cloud().positions).is_ground);
    EXPECT_FALSE(find_terrain({}).is_ground);
    const Vec3 one[] = {{1, 2, 3}};
    EXPECT_FALSE(find_terrain(one).is_ground);
}

}  // namespace
}  // namespace coppice
