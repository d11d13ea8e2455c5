#include "coppice/measure/match/cloud_distance.h"
#include "measure/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stop_token>

#include "errors.h"
#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

/// The unit square at height 0, seen from above: n x n quads.
PolygonMesh square(std::uint32_t n) {
    PolygonMesh out;
    for (std::uint32_t j = 0; j <= n; ++j) {
        for (std::uint32_t i = 0; i <= n; ++i)
            out.positions.push_back({static_cast<float>(i) / static_cast<float>(n),
                                     static_cast<float>(j) / static_cast<float>(n), 0});
    }
    for (std::uint32_t j = 0; j < n; ++j) {
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t at = j * (n + 1) + i;
            out.add_face(std::vector{at, at + 1, at + n + 2, at + n + 1});
        }
    }
    return out;
}

/// n x n points at the centres of the cells of the unit square, at a height; only those with x below `end`.
PointSet layer(std::uint32_t n, float height, float end = 1) {
    PointSet out;
    for (std::uint32_t j = 0; j < n; ++j) {
        for (std::uint32_t i = 0; i < n; ++i) {
            const float x = (static_cast<float>(i) + 0.5f) / static_cast<float>(n);
            if (x < end)
                out.positions.push_back({x, (static_cast<float>(j) + 0.5f) / static_cast<float>(n), height});
        }
    }
    return out;
}

/// Points around the z axis at this radius, from z = 0.5 to 9.5.
PointSet shell(double radius) {
    PointSet out;
    for (int k = 0; k <= 90; ++k) {
        for (int i = 0; i < 64; ++i) {
            const double t = 2 * std::numbers::pi * (i + 0.5) / 64;
            out.positions.push_back(Vec3(Vec3d{radius * std::cos(t), radius * std::sin(t), 0.5 + 0.1 * k}));
        }
    }
    return out;
}

TEST(CloudDistances, OfALayerAboveAPlaneAreItsHeight) {
    const CloudDistances found = cloud_distances(square(10), layer(50, 0.1f), nullptr);
    const CloudDistanceReport& r = found.report;
    EXPECT_FALSE(r.closed);
    const DistanceSummary& to = r.whole.to_surface;
    EXPECT_EQ(to.n, 2500u);
    for (const double d : {to.mean, to.p50, to.p95, to.max}) EXPECT_NEAR(d, 0.1, 1e-7);
    EXPECT_FALSE(to.bias);  // a square has no inside
    // Back: the point in the middle of the cell is at most half a diagonal of 0.02 away, with a mean of the
    // squares of both coordinates together of 0.01^2 / 1.5.
    const DistanceSummary& back = r.whole.to_cloud;
    EXPECT_EQ(back.n, 10'000u);
    EXPECT_GE(back.p50, 0.1 - 1e-7);
    EXPECT_LE(back.max, std::sqrt(0.01 + 0.0002) + 1e-7);
    EXPECT_NEAR(r.support, 0.06, 1e-6);  // three spacings of 0.02
    EXPECT_EQ(r.whole.bare_percent, 100);
    EXPECT_FALSE(r.forks);
    EXPECT_EQ(r.whole.to_surface_radius.n, 0u);
    ASSERT_EQ(found.of_points.size(), 2500u);
    EXPECT_NEAR(found.of_points[17], 0.1, 1e-7);
}

TEST(CloudDistances, BehindAnOpenSurfaceAreNegativePerPointOnly) {
    const CloudDistances found = cloud_distances(square(10), layer(50, -0.1f), nullptr);
    EXPECT_NEAR(found.of_points[17], -0.1, 1e-7);
    EXPECT_NEAR(found.report.whole.to_surface.mean, 0.1, 1e-7);
    EXPECT_FALSE(found.report.whole.to_surface.bias);
}

TEST(CloudDistances, SurfaceFarFromPointsIsBare) {
    // Points over x < 0.5, the last at 0.49: with a support of 0.1 the surface beyond 0.49 + sqrt(0.1^2 -
    // 0.01^2) = 0.5895 is bare, except for the gaps between points, less than 0.0002 in length.
    const CloudDistances found =
        cloud_distances(square(10), layer(50, 0.01f, 0.5f), nullptr, {.samples = 100'000, .support = 0.1f});
    EXPECT_NEAR(found.report.whole.bare_percent, 41.05, 0.1);
    EXPECT_EQ(found.report.whole.to_cloud.n, 100'000u);
    EXPECT_NEAR(found.report.whole.to_cloud.max, 0.51, 0.01);
}

TEST(CloudDistances, BiasDistinguishesInsideFromOutside) {
    // 256 sides and radius 0.5: the chords are at most 0.5 (1 - cos(pi / 256)) = 3.8e-5 inside.
    const PolygonMesh pole = capsule(256, 32, 0.5f, 0, 10);
    for (const double shift : {0.05, -0.05}) {
        const CloudDistanceReport r = cloud_distances(pole, shell(0.5 + shift), nullptr).report;
        EXPECT_TRUE(r.closed);
        ASSERT_TRUE(r.whole.to_surface.bias);
        EXPECT_NEAR(*r.whole.to_surface.bias, shift, 5e-5);
        EXPECT_NEAR(r.whole.to_surface.mean, 0.05, 5e-5);
        EXPECT_NEAR(r.whole.to_surface.max, 0.05, 5e-5);
    }
    const CloudDistanceReport turned = cloud_distances(inverted(pole), shell(0.55), nullptr).report;
    EXPECT_FALSE(turned.closed);
}

TEST(CloudDistances, InRadiiAreRelativeToTheSkeleton) {
    const Skeleton axis({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {0.5f, 0.5f});
    const CloudDistanceReport r = cloud_distances(capsule(256, 32, 0.5f, 0, 10), shell(0.55), &axis).report;
    EXPECT_NEAR(r.whole.to_surface_radius.mean, 0.1, 1e-4);
    EXPECT_NEAR(*r.whole.to_surface_radius.bias, 0.1, 1e-4);
    EXPECT_EQ(r.whole.to_cloud_radius.n, 10'000u);
    EXPECT_EQ(r.forks, 0u);
    EXPECT_EQ(r.at_forks, CloudDistanceSummary{});
}

TEST(CloudDistances, AtForksAreLimitedToTwoRadii) {
    // The node with three neighbours is at the centre of the square, the radius of its ball of two radii is
    // 0.2. Points in it are 0.01 above, the others 0.02.
    const Skeleton fork({kRoot, NodeId(0), NodeId(1), NodeId(1)},
                        {{0.5f, 0.5f, -1}, {0.5f, 0.5f, 0}, {0, 0.5f, 0}, {1, 0.5f, 0}},
                        {0.1f, 0.1f, 0.1f, 0.1f});
    PointSet cloud = layer(100, 0.02f);
    std::uint64_t near = 0;
    for (Vec3& p : cloud.positions) {
        if (std::hypot(p.x - 0.5f, p.y - 0.5f, 0.01f) > 0.2f) continue;
        p.z = 0.01f;
        ++near;
    }
    const CloudDistanceReport r = cloud_distances(square(10), cloud, &fork).report;
    EXPECT_EQ(r.forks, 1u);
    EXPECT_EQ(r.at_forks.to_surface.n, near);
    EXPECT_NEAR(r.at_forks.to_surface.mean, 0.01, 1e-7);
    EXPECT_NEAR(r.at_forks.to_surface_radius.max, 0.1, 1e-6);
    EXPECT_NEAR(r.whole.to_surface.max, 0.02, 1e-7);
    // Of the surface, the disc of radius 0.2: its share of the 10,000 samples.
    EXPECT_NEAR(static_cast<double>(r.at_forks.to_cloud.n), 1e4 * std::numbers::pi * 0.04, 15);
    EXPECT_EQ(r.at_forks.bare_percent, 0);
    const CloudDistanceReport wide = cloud_distances(square(10), cloud, &fork, {.fork_reach = 20}).report;
    EXPECT_EQ(wide.at_forks, wide.whole);
}

TEST(CloudDistances, RespectOrigins) {
    const Vec3d far{500'000, 5'000'000, 250};
    PolygonMesh plane = square(10);
    PointSet cloud = layer(50, 0.1f);
    const CloudDistances before = cloud_distances(plane, cloud, nullptr);
    plane.origin = far;
    cloud.origin = far + Vec3d{0, 0, 0.25};
    EXPECT_NEAR(cloud_distances(plane, cloud, nullptr).report.whole.to_surface.mean, 0.35, 1e-7);
    EXPECT_NEAR(cloud_distances(plane, cloud, nullptr).report.whole.to_cloud.p50, 0.35, 1e-3);
    cloud.origin = far;
    EXPECT_EQ(cloud_distances(plane, cloud, nullptr).report, before.report);
}

TEST(CloudDistances, AreBitIdenticalForAnyNumberOfThreads) {
    const Skeleton axis({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {0.5f, 0.5f});
    const PolygonMesh pole = capsule(64, 16, 0.5f, 0, 10);
    const PointSet cloud = merged(shell(0.52), shell(0.47));
    const CloudDistances one = cloud_distances(pole, cloud, &axis, {}, {.threads = 1});
    for (const unsigned threads : {2u, 5u}) {
        const CloudDistances many = cloud_distances(pole, cloud, &axis, {}, {.threads = threads});
        EXPECT_EQ(many.report, one.report);
        EXPECT_EQ(many.of_points, one.of_points);
    }
}

TEST(CloudDistances, RejectInvalidInput) {
    const auto error = [](const PolygonMesh& mesh, const PointSet& cloud, CloudDistanceOptions options = {}) {
        return test::error_of([&] { cloud_distances(mesh, cloud, nullptr, options); });
    };
    EXPECT_EQ(error(square(2), {}), "check: the cloud has no points");
    EXPECT_EQ(error({}, layer(5, 0)), "check: the mesh has no faces to measure a cloud from");
    const PolygonMesh flat = polygons({{0, 0, 0}, {1, 0, 0}, {0.5f, 0, 0}}, {{0, 1, 2}});
    EXPECT_EQ(error(flat, layer(5, 0)), "check: the mesh has no area to measure a cloud from");
    EXPECT_NE(error(square(2), layer(5, 0), {.fork_reach = 0}).find("fork_reach"), std::string::npos);

    PointSet far = layer(5, 0);
    far.origin = {0, 0, 1000};
    EXPECT_EQ(
        error(square(2), far),
        "check: the cloud is 1000 m away from the mesh; make sure that both are in the same place and unit. "
        "Their centres differ by (0, 0, 1000) m");
    PointSet millimetres = layer(50, 0.1f);
    for (Vec3& p : millimetres.positions) p = p * 1000;
    EXPECT_EQ(error(square(2), millimetres),
              "check: the cloud is about 1000 times as large as the mesh and hardly overlaps it; make sure "
              "that both are in "
              "the same unit");
    PointSet kilometres = layer(50, 0.1f);
    for (Vec3& p : kilometres.positions) p = p / 1000;
    EXPECT_NE(error(square(2), kilometres).find("about 0.001 times as large"), std::string::npos);
}

TEST(CloudDistances, AcceptPartialCloudsAndSurroundings) {
    PointSet few = layer(50, 0);
    for (Vec3& p : few.positions) p = p / 100;  // only a corner was scanned
    EXPECT_LT(cloud_distances(square(2), few, nullptr).report.whole.to_surface.max, 1e-9);
    PointSet stand = layer(50, 0);
    for (int i = -50; i < 50; ++i) {
        for (int j = -50; j < 50; ++j)
            stand.positions.push_back({static_cast<float>(i), static_cast<float>(j), 3});
    }
    EXPECT_LT(cloud_distances(square(2), stand, nullptr).report.whole.to_cloud.p95, 0.02);
}

TEST(CloudDistances, AcceptOnePoint) {
    PointSet one;
    one.positions.push_back({0.5f, 0.5f, 0.5f});
    const CloudDistanceReport r = cloud_distances(square(2), one, nullptr).report;
    EXPECT_EQ(r.whole.to_surface.n, 1u);
    EXPECT_EQ(r.whole.to_surface.p95, 0.5);
    EXPECT_EQ(r.support, 0);  // no spacing
    EXPECT_EQ(r.whole.bare_percent, 100);
}

TEST(CloudDistances, CanBeCancelled) {
    std::stop_source source;
    source.request_stop();
    EXPECT_THROW(cloud_distances(square(10), layer(50, 0), nullptr, {}, {.stop = source.get_token()}),
                 Cancelled);
}

}  // namespace
}  // namespace coppice
