#include "coppice/measure/convex_hull.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/measure/predicates_internal.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"

namespace coppice {
namespace {

/// Checks that the mesh is closed, has the Euler characteristic of a ball, and no point is outside: only the
/// hull satisfies all of that.
void expect_hull(const TriMesh& hull, std::span<const Vec3> points) {
    const PolygonMesh mesh = to_polygons(hull);
    EXPECT_TRUE(topology(mesh).watertight());
    EXPECT_EQ(topology(mesh).euler, 2);
    for (const auto& [a, b, c] : hull.triangles) {
        ASSERT_FALSE(is_degenerate({hull.positions[a], hull.positions[b], hull.positions[c]}));
        for (const Vec3 p : points)
            ASSERT_LE(orientation(hull.positions[a], hull.positions[b], hull.positions[c], p), 0);
    }
}

std::vector<Vec3> ball(std::size_t size, bool only_surface) {
    const CounterRandom random(1, 2);
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < size; ++i) {
        const double z = random.uniform(3 * i, -1, 1),
                     turn = random.uniform(3 * i + 1, 0, 2 * std::numbers::pi);
        const double wide = std::sqrt(1 - z * z), r = only_surface ? 1 : std::cbrt(random.uniform(3 * i + 2));
        out.emplace_back(Vec3(Vec3d{r * wide * std::cos(turn), r * wide * std::sin(turn), r * z}));
    }
    return out;
}

TEST(ConvexHull, OfABoxOfPointsIsTheBox) {
    // A grid of 5 x 4 x 3 points; all faces and edges contain additional points: 4 x 3 x 2 = 24.
    std::vector<Vec3> points;
    for (int x = 0; x < 5; ++x)
        for (int y = 0; y < 4; ++y)
            for (int z = 0; z < 3; ++z) points.emplace_back(float(x), float(y), float(z));
    const TriMesh hull = convex_hull(points);
    expect_hull(hull, points);
    const ShapeReport s = shape(to_polygons(hull));
    EXPECT_NEAR(s.signed_volume, 24, 1e-12);
    EXPECT_NEAR(s.area, 2 * (4 * 3 + 4 * 2 + 3 * 2), 1e-12);
}

TEST(ConvexHull, OfATetrahedronIsItself) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const TriMesh hull = convex_hull(points);
    expect_hull(hull, points);
    EXPECT_EQ(hull.triangles.size(), 4u);
    EXPECT_NEAR(signed_volume(to_polygons(hull)), 1.0 / 6, 1e-12);
}

TEST(ConvexHull, ContainsBallsOfPoints) {
    for (const bool only_surface : {false, true}) {
        const std::vector<Vec3> points = ball(3000, only_surface);
        const TriMesh hull = convex_hull(points);
        expect_hull(hull, points);
        // V - E + F = 2 with triangles: F = 2 V - 4. On a sphere almost all points are corners.
        EXPECT_EQ(hull.triangles.size(), 2 * hull.positions.size() - 4);
        EXPECT_EQ(hull.positions.size() > 2900, only_surface);
        EXPECT_NEAR(signed_volume(to_polygons(hull)), 4.0 / 3 * std::numbers::pi, only_surface ? 0.02 : 0.6);
    }
}

TEST(ConvexHull, OfAConeHasItsRimAndApex) {
    // Many corners share one: the apex is inserted after most of the rim.
    constexpr int kRim = 4000;
    std::vector<Vec3> points{{0, 0, 3}};
    for (int i = 0; i < kRim; ++i) {
        const double turn = 2 * std::numbers::pi * i / kRim;
        points.emplace_back(Vec3(Vec3d{2 * std::cos(turn), 2 * std::sin(turn), 0.001 * std::cos(3 * turn)}));
    }
    // pi 2^2 3 / 3, except for the variation of the rim's height by a thousandth
    EXPECT_NEAR(signed_volume(to_polygons(convex_hull(points))), 4 * std::numbers::pi, 0.02);
}

TEST(ConvexHull, IsEmptyForFlatInput) {
    EXPECT_TRUE(convex_hull({}).triangles.empty());
    EXPECT_TRUE(convex_hull(std::vector<Vec3>(9, Vec3{1, 2, 3})).positions.empty());
    std::vector<Vec3> line, plane;
    for (int i = 0; i < 50; ++i) {
        line.emplace_back(float(i), 2 * float(i), 0.f);
        plane.emplace_back(float(i % 7), float(i / 7), 1.f);
    }
    EXPECT_TRUE(convex_hull(line).triangles.empty());
    EXPECT_TRUE(convex_hull(plane).triangles.empty());
}

TEST(ConvexHull, AcceptsNearlyFlatInput) {
    // A plane of points, one of which is offset by the smallest possible number.
    std::vector<Vec3> points;
    for (int i = 0; i < 100; ++i) points.emplace_back(float(i % 10), float(i / 10), 1.f);
    points[55].z = std::nextafter(1.f, 2.f);
    const TriMesh hull = convex_hull(points);
    expect_hull(hull, points);
    EXPECT_NEAR(signed_volume(to_polygons(hull)), 81.0 / 3 * 0x1p-23, 1e-9);
}

}  // namespace
}  // namespace coppice
