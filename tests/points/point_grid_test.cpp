#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/points/sampling/point_grid_internal.h"
#include "coppice/points/sampling/point_hash_internal.h"

namespace coppice::points_internal {
namespace {

std::vector<Vec3> random_points(std::size_t count, Vec3d size) {
    const CounterRandom random(3, 0);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
        const auto draw = [&](std::size_t axis) { return random.uniform(3 * i + axis, -1, 1); };
        points.push_back(Vec3(Vec3d{size.x * draw(0), size.y * draw(1), size.z * draw(2)}));
    }
    return points;
}

using Found = std::vector<std::pair<std::uint32_t, double>>;

// A hash grid visits the same points in the same order: sums over neighbours are bit-identical.
TEST(PointGrid, VisitsThePointsOfAHashGridInTheSameOrder) {
    constexpr double kEdge = 0.1;
    for (const Vec3d size :
         {Vec3d{1, 1, 1}, Vec3d{1, 1e-3, 1}, Vec3d{1e-3, 1e-3, 2}, Vec3d{1e-3, 1e-3, 1e-3}}) {
        const std::vector<Vec3> points = random_points(1500, size);
        const PointGrid grid(points, kEdge, {});
        PointHash hash(kEdge, points.size());
        for (const Vec3 p : points) hash.insert(p);
        for (const Vec3 p : random_points(50, size * 1.3)) {
            for (const double radius : {0.03, 0.1, 0.25}) {
                Found by_grid, by_hash;
                grid.visit(p, radius, [&](std::uint32_t place, double d2) {
                    EXPECT_EQ(grid[place], points[grid.number(place)]);
                    by_grid.emplace_back(grid.number(place), d2);
                    return true;
                });
                hash.visit(p, radius, [&](std::uint32_t n, double d2) {
                    by_hash.emplace_back(n, d2);
                    return true;
                });
                EXPECT_EQ(by_grid, by_hash);
            }
        }
    }
}

TEST(PointGrid, VisitorCanStopTheVisit) {
    const std::vector<Vec3> heap(100, Vec3{1, 2, 3});
    const PointGrid grid(heap, 1, {});
    int visits = 0;
    EXPECT_FALSE(grid.visit({1, 2, 3}, 0.5, [&](std::uint32_t, double) { return ++visits < 3; }));
    EXPECT_EQ(visits, 3);
    EXPECT_TRUE(grid.visit({9, 9, 9}, 0.5, [](std::uint32_t, double) { return false; }));
}

TEST(PointGrid, AcceptsNoPoints) {
    const PointGrid grid({}, 1, {});
    EXPECT_EQ(grid.size(), 0u);
    EXPECT_TRUE(grid.visit({}, 1, [](std::uint32_t, double) { return false; }));
}

}  // namespace
}  // namespace coppice::points_internal
