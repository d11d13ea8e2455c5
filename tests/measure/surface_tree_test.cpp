#include "coppice/measure/surface_tree.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/random.h"
#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

TEST(SurfaceTree, ComputesTheDistanceToACube) {
    const PolygonMesh m = cube();
    const SurfaceTree tree(m);
    EXPECT_DOUBLE_EQ(tree.distance({0.5, 0.5, 0.5}), 0.5);  // a face
    EXPECT_DOUBLE_EQ(tree.distance({0.5, 0.5, 3}), 2);
    EXPECT_DOUBLE_EQ(tree.distance({2, 2, 0.3}), std::sqrt(2.0));   // an edge
    EXPECT_DOUBLE_EQ(tree.distance({-1, -1, -1}), std::sqrt(3.0));  // a corner
    EXPECT_DOUBLE_EQ(tree.distance({0.25, 0.5, 0}), 0);
}

TEST(SurfaceTree, DistanceToATriangleIsTheMinimumOverItsPoints) {
    const Vec3d a{0, 0, 0}, b{2, 0, 0.5}, c{0.3, 1, 0};
    const CounterRandom random(7, 0);
    for (std::uint32_t i = 0; i < 200; ++i) {
        const Vec3d p{random.uniform(3 * i, -2, 3), random.uniform(3 * i + 1, -2, 3),
                      random.uniform(3 * i + 2, -2, 2)};
        double least = 1e300;
        for (int u = 0; u <= 200; ++u) {
            for (int v = 0; u + v <= 200; ++v) {
                least = std::min(least, distance(p, a + (b - a) * (u / 200.0) + (c - a) * (v / 200.0)));
            }
        }
        const double ours = std::sqrt(distance_squared(p, a, b, c));
        EXPECT_LE(ours, least + 1e-12);
        EXPECT_NEAR(ours, least, 0.011);  // the samples are at most 0.0104 apart
    }
}

TEST(SurfaceTree, IsWithinMatchesTheDistance) {
    const PolygonMesh m = cube();
    const SurfaceTree tree(m);
    EXPECT_TRUE(tree.is_within({0.5, 0.5, 3}, 2));
    EXPECT_FALSE(tree.is_within({0.5, 0.5, 3}, 1.99));
    EXPECT_TRUE(tree.is_within({0.5, 0.5, 0.5}, 0.5));
    EXPECT_FALSE(tree.is_within({0.5, 0.5, 0.5}, 0.49));
    const PolygonMesh none;
    EXPECT_FALSE(SurfaceTree(none).is_within({0, 0, 0}, 1e9));
}

TEST(SurfaceTree, ClosestPointMatchesExhaustiveSearch) {
    const PolygonMesh m = torus(20, 50, 1, 3);
    const SurfaceTree tree(m);
    EXPECT_EQ(tree.boxes().size(), m.face_count());
    const CounterRandom random(8, 0);
    for (std::uint32_t i = 0; i < 50; ++i) {
        const Vec3d p{random.uniform(3 * i, -5, 5), random.uniform(3 * i + 1, -5, 5),
                      random.uniform(3 * i + 2, -2, 2)};
        double least = 1e300;
        for (std::uint32_t f = 0; f < m.face_count(); ++f) {
            const SurfaceTree::TriangleRun& run = tree.run(f);
            for (const Triangle& t : tree.triangles(run)) {
                least = std::min(least, distance_squared(p, Vec3d(m.positions[t[0]]),
                                                         Vec3d(m.positions[t[1]]), Vec3d(m.positions[t[2]])));
            }
        }
        EXPECT_EQ(tree.distance(p), std::sqrt(least));
    }
}

TEST(SurfaceTree, SignedDistanceIsNegativeInside) {
    const PolygonMesh m = cube();
    const SurfaceTree tree(m);
    EXPECT_DOUBLE_EQ(tree.signed_distance({0.5, 0.5, 0.5}), -0.5);
    EXPECT_DOUBLE_EQ(tree.signed_distance({0.5, 0.5, 3}), 2);
    EXPECT_DOUBLE_EQ(tree.signed_distance({2, 2, 0.3}), std::sqrt(2.0)) << "an edge";
    EXPECT_DOUBLE_EQ(tree.signed_distance({-1, -1, -1}), std::sqrt(3.0)) << "a corner";
    EXPECT_DOUBLE_EQ(tree.signed_distance({0.25, 0.5, 0}), 0);
    EXPECT_TRUE(std::isinf(SurfaceTree(PolygonMesh{}).signed_distance({0, 0, 0})));
    const PolygonMesh ring = torus(20, 50, 1, 3);
    const SurfaceTree round(ring);
    const CounterRandom random(9, 0);
    for (std::uint32_t i = 0; i < 2000; ++i) {
        const Vec3d p{random.uniform(3 * i, -5, 5), random.uniform(3 * i + 1, -5, 5),
                      random.uniform(3 * i + 2, -2, 2)};
        const double true_distance = std::hypot(std::hypot(p.x, p.y) - 3, p.z) - 1;
        EXPECT_NEAR(round.signed_distance(p), true_distance, 0.03);
        EXPECT_EQ(std::fabs(round.signed_distance(p)), round.distance(p));
    }
}

TEST(SurfaceTree, SignIsCorrectAtSharpEdges) {
    // A wedge of 10 degrees: beyond its edge a point is behind the plane of neither or of one of its sides.
    const float h = std::tan(0.0873f);
    const PolygonMesh wedge =
        polygons({{0, 0, 0}, {0, 1, 0}, {-1, 0, h}, {-1, 1, h}, {-1, 0, -h}, {-1, 1, -h}},
                 {{0, 1, 3, 2}, {1, 0, 4, 5}, {2, 3, 5, 4}, {0, 2, 4}, {1, 5, 3}});
    const SurfaceTree tree(wedge);
    for (const double z : {-1.0, -0.1, 0.0, 0.1, 1.0}) {
        EXPECT_NEAR(tree.signed_distance({0.05, 0.5, z * 0.05}), std::hypot(0.05, z * 0.05), 1e-9) << z;
    }
    EXPECT_LT(tree.signed_distance({-0.5, 0.5, 0}), 0);
}

TEST(SurfaceTree, ExcludesDegenerateTrianglesAndSplitsLargeFaces) {
    const PolygonMesh line = polygons({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}});
    EXPECT_EQ(SurfaceTree(line).boxes().size(), 0u);
    EXPECT_TRUE(std::isinf(SurfaceTree(line).distance({0, 0, 0})));
    EXPECT_TRUE(std::isinf(SurfaceTree(PolygonMesh{}).distance({0, 0, 0})));
    // Seven corners: five triangles in three items.
    PolygonMesh disc;
    for (std::uint32_t i = 0; i < 7; ++i)
        disc.positions.push_back({std::cos(angle(i, 7)), std::sin(angle(i, 7)), 0});
    disc.add_face(std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6});
    const SurfaceTree tree(disc);
    ASSERT_EQ(tree.boxes().size(), 3u);
    EXPECT_EQ(tree.run(0).count + tree.run(1).count + tree.run(2).count, 5u);
    EXPECT_DOUBLE_EQ(tree.distance({0, 0, 2}), 2);
}

}  // namespace
}  // namespace coppice
