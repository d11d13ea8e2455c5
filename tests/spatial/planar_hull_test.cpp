#include "coppice/spatial/planar_hull.h"

#include <gtest/gtest.h>

#include "coppice/base/random.h"

namespace coppice {
namespace {

std::vector<Vec3d> random_points(std::size_t count, std::uint64_t seed) {
    const CounterRandom random(seed, 0);
    std::vector<Vec3d> out;
    for (std::size_t i = 0; i < count; ++i)
        out.push_back({random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2)});
    return out;
}

TEST(PlanarHull, ContainsAllPoints) {
    const std::vector<Vec3d> points = random_points(200, 1), hull = compute_planar_hull(points);
    ASSERT_GE(hull.size(), 3u);
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vec3d a = hull[i], b = hull[(i + 1) % hull.size()];
        for (const Vec3d p : points) EXPECT_GE(turn_in_plan(a, b, p), 0);
    }
}

TEST(PlanarHull, HasTheCornersOfASquare) {
    const std::vector<Vec3d> hull =
        compute_planar_hull({{0, 0, 5}, {2, 0, 1}, {1, 0, 0}, {1, 1, 9}, {2, 2, 0}, {0, 2, 3}});
    EXPECT_EQ(hull, (std::vector<Vec3d>{{0, 0, 5}, {2, 0, 1}, {2, 2, 0}, {0, 2, 3}}));
    EXPECT_DOUBLE_EQ(compute_planar_area(hull), 4);
}

TEST(PlanarHull, HullOfHullsIsThatOfAllPoints) {
    const std::vector<Vec3d> points = random_points(90, 2);
    std::vector<Vec3d> corners;
    for (std::size_t first = 0; first < points.size(); first += 30) {
        const auto begin = points.begin() + static_cast<std::ptrdiff_t>(first);
        const std::vector<Vec3d> part = compute_planar_hull({begin, begin + 30});
        corners.insert(corners.end(), part.begin(), part.end());
    }
    EXPECT_EQ(compute_planar_hull(corners), compute_planar_hull(points));
}

TEST(PlanarHull, AcceptsDegenerateInput) {
    EXPECT_TRUE(compute_planar_hull({}).empty());
    EXPECT_EQ(compute_planar_hull({{1, 2, 3}}), (std::vector<Vec3d>{{1, 2, 3}}));
    const std::vector<Vec3d> line = compute_planar_hull({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}});
    EXPECT_EQ(line, (std::vector<Vec3d>{{0, 0, 0}, {2, 2, 0}}));
    EXPECT_EQ(compute_planar_area(line), 0);
}

}  // namespace
}  // namespace coppice
