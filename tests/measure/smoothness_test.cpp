#include "coppice/measure/smoothness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace coppice {
namespace {

constexpr double kPi = std::numbers::pi;

// A grid of quads, (columns + 1) x (rows + 1) vertices; with `ring` the columns form a closed ring.
template <class Place>
PolygonMesh grid(std::uint32_t columns, std::uint32_t rows, bool ring, const Place& place) {
    PolygonMesh mesh;
    const std::uint32_t across = ring ? columns : columns + 1;
    for (std::uint32_t j = 0; j <= rows; ++j)
        for (std::uint32_t i = 0; i < across; ++i) mesh.positions.push_back(Vec3(place(i, j)));
    for (std::uint32_t j = 0; j < rows; ++j) {
        for (std::uint32_t i = 0; i < columns; ++i) {
            const std::uint32_t k = (i + 1) % across;
            mesh.corners.insert(mesh.corners.end(),
                                {j * across + i, j * across + k, (j + 1) * across + k, (j + 1) * across + i});
            mesh.first.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
        }
    }
    return mesh;
}

PolygonMesh tube(double radius, double length, std::uint32_t sides, std::uint32_t rows) {
    return grid(sides, rows, true, [&](std::uint32_t i, std::uint32_t j) {
        const double a = 2 * kPi * i / sides;
        return Vec3d{radius * std::cos(a), radius * std::sin(a), length * j / rows};
    });
}

TEST(Smoothness, BendingOfATubeIsProportionalToLengthOverRadius) {
    for (const double scale : {1.0, 0.01}) {
        for (const std::uint32_t sides : {32u, 64u, 128u}) {
            const SmoothnessReport r = smoothness(tube(scale, 5 * scale, sides, 20), nullptr);
            EXPECT_NEAR(r.whole.bending, 2 * kPi * 5, 0.1) << sides;
            // Of the edges along the tube; those across it are flat.
            EXPECT_NEAR(r.whole.face_angle.max, 360.0 / sides, 1e-3);
            EXPECT_NEAR(r.whole.face_angle.min, 0, 1e-3);
            EXPECT_FALSE(r.forks);
        }
    }
}

TEST(Smoothness, BendingOfASphereIsEightPi) {
    // The zone at least 30 degrees from both poles: its share of the area is the cosine of that.
    const PolygonMesh zone = grid(128, 64, true, [](std::uint32_t i, std::uint32_t j) {
        const double a = 2 * kPi * i / 128, polar = kPi * (1.0 / 6 + 4.0 / 6 * (64 - j) / 64);
        return 3 * Vec3d{std::sin(polar) * std::cos(a), std::sin(polar) * std::sin(a), std::cos(polar)};
    });
    EXPECT_NEAR(smoothness(zone, nullptr).whole.bending, 8 * kPi * std::cos(kPi / 6), 0.2);
}

TEST(Smoothness, BendingOfACreaseIncreasesWithItsResolution) {
    const auto folded = [](std::uint32_t n) {
        return smoothness(grid(n, n, false,
                               [n](std::uint32_t i, std::uint32_t j) {
                                   const double x = 2.0 * i / n - 1;
                                   return Vec3d{x, 2.0 * j / n, std::abs(x)};
                               }),
                          nullptr)
            .whole;
    };
    EXPECT_NEAR(folded(8).face_angle.max, 90, 1e-3);
    EXPECT_NEAR(folded(8).face_angle.p50, 0, 1e-6);
    EXPECT_NEAR(folded(16).bending / folded(8).bending, 2, 1e-3);
}

TEST(Smoothness, ForksAreMeasuredWithinTwoRadii) {
    // A tube of radius 1 along z with a node in its middle from which two others start: the tube in the ball
    // of radius 2 has twice the length of the root of 3.
    const Skeleton s({NodeId{}, NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 5}, {0, 0, 10}, {0, 5, 5}}, {1, 1, 1, 0.1f}, {100, 0, 0});
    PolygonMesh mesh = tube(1, 10, 64, 400);
    mesh.origin = {100, 0, 0};
    const SmoothnessReport r = smoothness(mesh, &s);
    ASSERT_TRUE(r.forks);
    EXPECT_NEAR(r.forks->bending, 2 * kPi * 2 * std::sqrt(3.0), 0.1);
    EXPECT_LT(r.forks->face_angle.n, r.whole.face_angle.n / 2);
    mesh.origin = {0, 0, 0};
    EXPECT_EQ(smoothness(mesh, &s).forks->bending, 0);
}

TEST(Smoothness, ExcludesNonManifoldEdgesAndDegenerateFaces) {
    // Three triangles at one edge, and one without area.
    PolygonMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {2, 0, 0}};
    mesh.corners = {0, 1, 2, 1, 0, 3, 0, 1, 4, 0, 1, 5};
    mesh.first = {0, 3, 6, 9, 12};
    const SmoothnessReport r = smoothness(mesh, nullptr);
    EXPECT_EQ(r.whole.face_angle.n, 0u);
    EXPECT_TRUE(std::isfinite(r.whole.bending));
    EXPECT_EQ(smoothness(PolygonMesh{}, nullptr), SmoothnessReport{});
}

TEST(Smoothness, IsBitIdenticalForAnyNumberOfThreads) {
    const PolygonMesh mesh = tube(1, 5, 100, 300);
    EXPECT_EQ(smoothness(mesh, nullptr, {.threads = 1}), smoothness(mesh, nullptr, {.threads = 4}));
}

}  // namespace
}  // namespace coppice
