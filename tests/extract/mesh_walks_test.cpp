#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coppice/base/id.h"
#include "coppice/extract/mesh/distance_internal.h"
#include "coppice/extract/mesh/ring_measure_internal.h"
#include "coppice/extract/mesh/rings_internal.h"
#include "coppice/extract/mesh/surface_internal.h"
#include "extract/mesh_support.h"

namespace coppice::extract_internal {
namespace {

using shapes::tube;

Surface surface(const PolygonMesh& mesh) {
    Surface s;
    const TriMesh triangles = triangulate(mesh);
    s.positions = triangles.positions;
    s.triangles.assign(triangles.triangles.begin(), triangles.triangles.end());
    connect(s);
    return s;
}

TEST(Surface, TwinsAreOnTheSameEdge) {
    const Surface s = surface(tube({0, 0, 0}, {0, 0, 1}, 0.1f));
    for (std::uint32_t h = 0; h < s.twin.size(); ++h) {
        ASSERT_NE(s.twin[h], kNoIndex);
        EXPECT_EQ(s.twin[s.twin[h]], h);
        EXPECT_EQ(s.from(s.twin[h]), s.to(h));
        EXPECT_EQ(s.to(s.twin[h]), s.from(h));
    }
}

TEST(Surface, AnOpenTubeHasTwoBorders) {
    const Surface s = surface(tube({0, 0, 0}, {0, 0, 1}, 0.1f, {.sides = 9, .closed = false}));
    const auto loops = border_loops(s);
    ASSERT_EQ(loops.size(), 2u);
    EXPECT_EQ(loops[0].size(), 9u);
    EXPECT_EQ(loops[1].size(), 9u);
}

// Of three triangles on an edge the two coplanar ones are adjacent.
TEST(Surface, CoplanarTrianglesAtANonManifoldEdgeAreTwins) {
    PolygonMesh m;
    for (const Vec3 p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1)})
        m.positions.push_back(p);
    m.add_face(std::vector<std::uint32_t>{0, 1, 2});
    m.add_face(std::vector<std::uint32_t>{0, 1, 4});
    m.add_face(std::vector<std::uint32_t>{1, 0, 3});
    const Surface s = surface(m);
    EXPECT_EQ(s.twin[0], 6u);
    EXPECT_EQ(s.twin[3], kNoIndex);
    EXPECT_EQ(s.component_count, 1u);
}

TEST(MarchDistances, AreNearlyStraightOnAPlane) {
    // A grid of 21 x 21 points at intervals of 0.1, with diagonals.
    PolygonMesh m;
    for (int y = 0; y <= 20; ++y)
        for (int x = 0; x <= 20; ++x)
            m.positions.push_back({0.1f * static_cast<float>(x), 0.1f * static_cast<float>(y), 0});
    for (std::uint32_t y = 0; y < 20; ++y)
        for (std::uint32_t x = 0; x < 20; ++x)
            m.add_face(
                std::vector<std::uint32_t>{21 * y + x, 21 * y + x + 1, 21 * y + x + 22, 21 * y + x + 21});
    const Surface s = surface(m);
    const std::vector<std::uint32_t> source{0};
    const std::vector<double> d = march_distances(s, source, {});
    for (std::uint32_t v = 0; v < s.size(); ++v) {
        const double straight = length(s.positions[v]);
        EXPECT_GE(d[v], straight - 1e-6);
        EXPECT_LE(d[v], 1.09 * straight + 1e-6);  // along edges it would be up to 1.41 times the distance
    }
    EXPECT_NEAR(d[20], 2, 1e-6);
}

TEST(MarchDistances, AreInfiniteOnOtherComponents) {
    const Surface s =
        surface(shapes::both(tube({0, 0, 0}, {0, 0, 1}, 0.1f), tube({2, 0, 0}, {2, 0, 1}, 0.1f)));
    const std::vector<std::uint32_t> source{0};
    const std::vector<double> d = march_distances(s, source, {});
    for (std::uint32_t v = 0; v < s.size(); ++v)
        EXPECT_EQ(std::isfinite(d[v]), s.component[v] == s.component[0]);
}

TEST(MeasureRing, CircleHasItsCenterAndRadius) {
    std::vector<Vec3d> points;
    for (int i = 0; i < 60; ++i) {
        const double a = std::numbers::pi * i / 30;
        points.push_back({3 + 2 * std::cos(a), 1 + 2 * std::sin(a), 5});
    }
    const Ring r = measure_ring(points, true);
    EXPECT_LT(distance(r.center, Vec3d(3, 1, 5)), 1e-9);
    EXPECT_NEAR(r.radius, 2, 0.01);
    EXPECT_LT(r.spread, 0.01);
}

// A section of the same cylinder at 45 degrees: projected along the area normal it is an ellipse about the
// axis.
TEST(MeasureRing, ATiltedSectionHasItsCenterOnTheAxis) {
    std::vector<Vec3d> points;
    for (int i = 0; i < 60; ++i) {
        const double a = std::numbers::pi * i / 30;
        points.push_back({std::cos(a), std::sin(a), std::cos(a)});
    }
    EXPECT_LT(length(measure_ring(points, true).center), 1e-9);
}

TEST(MeasureRing, AnArcHasTheCenterOfItsCircle) {
    std::vector<Vec3d> points;
    for (int i = 0; i <= 30; ++i) {
        const double a = std::numbers::pi * i / 40;
        points.push_back({2 * std::cos(a), 2 * std::sin(a), 0});
    }
    const Ring r = measure_ring(points, false);
    EXPECT_LT(length(r.center), 1e-6);
    EXPECT_NEAR(r.radius, 2, 0.01);
}

TEST(FollowChains, ForkHasTwoChains) {
    const Surface s = surface(shapes::make_surface(shapes::fork(), 0.04f));
    std::uint32_t low = 0;
    for (std::uint32_t v = 0; v < s.size(); ++v)
        if (s.positions[v].z < s.positions[low].z) low = v;
    const std::vector<std::uint32_t> source{low};
    const RingForest forest = follow_chains(s, march_distances(s, source, {}), std::vector<char>(1, 0), {});
    ASSERT_EQ(forest.chains.size(), 2u);
    EXPECT_EQ(forest.rings[forest.chains[0].end - 1].parent, kNoIndex);
    const std::uint32_t fork = forest.rings[forest.chains[1].end - 1].parent;
    ASSERT_NE(fork, kNoIndex);
    EXPECT_LT(distance(forest.rings[fork].center, Vec3d(0, 0, 2)), 0.4);
    for (const RingChain& chain : forest.chains) EXPECT_EQ(chain.touched, kNoIndex);
}

TEST(FollowChains, HandleHasOneChainThatTouchesAnother) {
    const Surface s = surface(shapes::torus(1, 0.1f, 120, 16));
    const std::vector<std::uint32_t> source{0};
    const RingForest forest = follow_chains(s, march_distances(s, source, {}), std::vector<char>(1, 0), {});
    ASSERT_EQ(forest.chains.size(), 2u);
    EXPECT_EQ(forest.chains[0].touched, kNoIndex);
    EXPECT_NE(forest.chains[1].touched, kNoIndex);
}

}  // namespace
}  // namespace coppice::extract_internal
