#include "coppice/pipeline/restore.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "coppice/measure/intersections.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/shape.h"
#include "errors.h"
#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;
using test::error_of;

constexpr std::uint32_t kSides = 48, kRings = 64;
constexpr float kHeight = 4;

/// A tube of radius(angle, z) around the z axis, moved sideways; open at both ends.
template <class Radius>
PolygonMesh make_tube(std::uint32_t sides, std::uint32_t rings, const Radius& radius, float x = 0) {
    return grid(sides, rings, false, [&](std::uint32_t i, std::uint32_t j) {
        const float t = angle(i, sides), z = kHeight * static_cast<float>(j) / static_cast<float>(rings);
        const float r = radius(t, z);
        return Vec3{x + r * std::cos(t), r * std::sin(t), z};
    });
}

QuadMesh to_quads(const PolygonMesh& m) {
    QuadMesh out;
    out.positions = m.positions;
    for (std::uint32_t f = 0; f < m.face_count(); ++f) {
        const auto q = m.face(f);
        out.quads.push_back({q[0], q[1], q[2], q[3]});
    }
    out.origin = m.origin;
    return out;
}

float plain(float, float) { return 1; }
float bumpy(float t, float z) { return 1 + 0.15f * std::sin(3 * t) * std::sin(4 * z); }

QuadMesh plain_tube() { return to_quads(make_tube(kSides, kRings, plain)); }

/// Axes along z of radius 1 at the given positions.
Skeleton axes(std::initializer_list<float> places) {
    std::vector<NodeId> parents;
    std::vector<Vec3> positions;
    for (const float x : places) {
        parents.push_back(NodeId::none());
        positions.push_back({x, 0, 0});
        parents.push_back(NodeId(static_cast<std::uint32_t>(positions.size() - 1)));
        positions.push_back({x, 0, kHeight});
    }
    const std::vector<float> radii(positions.size(), 1.0f);
    return Skeleton(std::move(parents), std::move(positions), radii);
}

std::size_t crossings(const PolygonMesh& m) { return crossing_faces(SurfaceTree(m), 1'000'000).pairs.size(); }

TEST(RestoreOffsets, ReproduceBumps) {
    QuadMesh mesh = plain_tube();
    const RestoreResult result = restore_offsets(mesh, make_tube(200, 300, bumpy), axes({0}));
    // The mean of |sin| is 2 / pi, and sines of different variables are independent.
    EXPECT_NEAR(result.report.distance_before.mean, 0.15 * 4 / (std::numbers::pi * std::numbers::pi), 0.006);
    EXPECT_LT(result.report.distance_after.mean, 1e-5);
    EXPECT_EQ(result.report.found, mesh.positions.size());
    EXPECT_EQ(result.report.pulled_back, 0u);
    ASSERT_EQ(result.offsets.size(), mesh.positions.size());
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const Vec3 p = mesh.positions[v];
        const float r = std::hypot(p.x, p.y);
        ASSERT_NEAR(r, bumpy(std::atan2(p.y, p.x), p.z), 1e-3) << v;
        ASSERT_NEAR(r, 1 + result.offsets[v], 1e-4) << v;
    }
    const PolygonMesh moved = to_polygons(mesh);
    const SurfaceTree surface(moved);
    for (const Vec3 p : make_tube(90, 110, bumpy).positions) ASSERT_LT(surface.distance(Vec3d(p)), 0.03);
}

TEST(RestoreOffsets, AreZeroWithoutANearbyOriginal) {
    const QuadMesh before = plain_tube();
    const PolygonMesh bumps = make_tube(60, 60, bumpy);
    for (const PolygonMesh& original : {PolygonMesh{}, make_tube(60, 60, bumpy, 50)}) {
        QuadMesh mesh = before;
        const RestoreResult result = restore_offsets(mesh, original, axes({0}));
        EXPECT_EQ(mesh.positions, before.positions);
        EXPECT_EQ(result.offsets, Buffer<float>(mesh.positions.size(), 0.0f));
        EXPECT_EQ(result.report.found, 0u);
    }
    QuadMesh mesh = before;  // too far for a short reach
    EXPECT_EQ(restore_offsets(mesh, make_tube(60, 60, [](float, float) { return 1.2f; }), axes({0}),
                              {.reach = 0.1f})
                  .report.found,
              0u);
    EXPECT_EQ(restore_offsets(mesh, bumps, axes({50})).report.found, 0u);  // no skeleton there
    QuadMesh nothing;
    EXPECT_EQ(restore_offsets(nothing, bumps, axes({0})).report, RestoreReport{});
}

TEST(RestoreOffsets, UseTheNearestFaceWithTheSameOrientation) {
    const auto wide = [](float, float) { return 1.3f; };
    const auto inner = [](float, float) { return 0.95f; };
    QuadMesh mesh = plain_tube();
    const PolygonMesh shell = both(make_tube(kSides, 8, wide), inverted(make_tube(kSides, 8, inner)));
    EXPECT_NEAR(restore_offsets(mesh, shell, axes({0})).report.offset.p50, 0.3, 1e-3);
    mesh = plain_tube();
    const PolygonMesh layers = both(make_tube(kSides, 8, wide), make_tube(kSides, 8, inner));
    EXPECT_NEAR(restore_offsets(mesh, layers, axes({0})).report.offset.p50, -0.05, 1e-3);
}

TEST(RestoreOffsets, ReverseInwardOriginals) {
    QuadMesh wanted = plain_tube();
    const PolygonMesh bumps = make_tube(200, 300, bumpy);
    EXPECT_FALSE(restore_offsets(wanted, bumps, axes({0})).report.turned);
    // The lower half of the tube, or all of it, faces inward.
    PolygonMesh partly;
    partly.positions = bumps.positions;
    for (std::uint32_t f = 0; f < bumps.face_count(); ++f) {
        std::vector<std::uint32_t> corners(bumps.face(f).begin(), bumps.face(f).end());
        if (f < bumps.face_count() / 2) std::ranges::reverse(corners);
        partly.add_face(corners);
    }
    for (PolygonMesh original : {inverted(bumps), partly}) {
        original.origin = {5, 0, 0};
        for (Vec3& p : original.positions) p.x -= 5;
        QuadMesh mesh = plain_tube();
        const RestoreResult result = restore_offsets(mesh, original, axes({0}));
        EXPECT_TRUE(result.report.turned);
        EXPECT_EQ(result.report.found, mesh.positions.size());
        for (std::size_t v = 0; v < mesh.positions.size(); ++v)
            ASSERT_LT(distance(mesh.positions[v], wanted.positions[v]), 1e-3) << v;
    }
}

TEST(RestoreOffsets, DecreaseToZeroWithoutAnOriginal) {
    // The original covers the lower half.
    PolygonMesh half;
    const PolygonMesh whole = make_tube(kSides, kRings, [](float, float) { return 1.2f; });
    half.positions = whole.positions;
    for (std::uint32_t f = 0; f < whole.face_count() / 2; ++f) half.add_face(whole.face(f));
    QuadMesh mesh = plain_tube();
    const RestoreResult result = restore_offsets(mesh, half, axes({0}), {.fade_passes = 10});
    EXPECT_EQ(result.report.found, kSides * (kRings / 2 + 1));
    EXPECT_EQ(result.report.faded, kSides * 10);
    for (std::uint32_t ring = 1; ring <= kRings; ++ring) {
        const float here = result.offsets[ring * kSides], below = result.offsets[(ring - 1) * kSides];
        if (ring <= kRings / 2) {
            EXPECT_NEAR(here, 0.2f, 1e-3) << ring;
        } else if (ring <= kRings / 2 + 10) {
            EXPECT_LT(here, below) << ring;
            EXPECT_GT(here, 0) << ring;
        } else {
            EXPECT_EQ(here, 0) << ring;
        }
    }
}

TEST(RestoreOffsets, AddNoSelfIntersections) {
    // Two tubes at a distance of 0.2 with originals that intersect each other.
    const auto wide = [](float t, float z) { return 1.2f + 0.05f * std::sin(5 * t) * std::sin(3 * z); };
    const PolygonMesh original = both(make_tube(kSides, kRings, wide), make_tube(kSides, kRings, wide, 2.2f));
    ASSERT_GT(crossings(original), 0u);
    QuadMesh mesh = to_quads(both(make_tube(kSides, kRings, plain), make_tube(kSides, kRings, plain, 2.2f)));
    const RestoreReport report = restore_offsets(mesh, original, axes({0, 2.2f})).report;
    EXPECT_EQ(crossings(to_polygons(mesh)), 0u);
    EXPECT_EQ(shape(mesh).inverted_faces, 0u);
    EXPECT_GT(report.pulled_back, 0u);
    EXPECT_LT(report.pulled_back, mesh.positions.size() / 3);
    EXPECT_LT(report.distance_after.mean, report.distance_before.mean / 3);
}

TEST(RestoreOffsets, PreserveExistingSelfIntersections) {
    QuadMesh mesh = to_quads(both(make_tube(kSides, kRings, plain), make_tube(kSides, kRings, plain, 1.5f)));
    const std::size_t before = crossings(to_polygons(mesh));
    ASSERT_GT(before, 0u);
    const RestoreReport report = restore_offsets(mesh, make_tube(200, 300, bumpy), axes({0, 1.5f})).report;
    EXPECT_LE(crossings(to_polygons(mesh)), before);
    EXPECT_LT(report.distance_after.p50, report.distance_before.p50);
}

TEST(RestoreOffsets, AddNoFoldsOverSteps) {
    const auto steps = [](float t, float z) {
        return 1 + 0.35f * std::tanh(20 * std::sin(7 * t)) * std::tanh(20 * std::sin(9 * z));
    };
    QuadMesh mesh = plain_tube();
    const RestoreReport report = restore_offsets(mesh, make_tube(400, 400, steps), axes({0})).report;
    EXPECT_EQ(crossings(to_polygons(mesh)), 0u);
    EXPECT_EQ(shape(mesh).inverted_faces, 0u);
    EXPECT_LT(report.distance_after.mean, report.distance_before.mean / 4);
}

TEST(RestoreOffsets, AreIndependentOfOrigins) {
    PolygonMesh original = make_tube(200, 300, bumpy);
    QuadMesh mesh = plain_tube();
    const RestoreResult expected = restore_offsets(mesh, original, axes({0}));
    original.origin = {-64, 128, 0};
    for (Vec3& p : original.positions) p = p - Vec3(original.origin);
    mesh = plain_tube();
    const RestoreResult result = restore_offsets(mesh, original, axes({0}));
    // Rounding of corners makes some quads of the original use their other diagonal.
    for (std::size_t v = 0; v < result.offsets.size(); ++v)
        ASSERT_NEAR(result.offsets[v], expected.offsets[v], 1e-3) << v;
}

TEST(RestoreOffsets, AreBitIdenticalForAnyNumberOfThreads) {
    const auto run = [](unsigned threads) {
        QuadMesh mesh = to_quads(make_tube(160, 120, plain));
        Context ctx;
        ctx.threads = threads;
        RestoreResult result = restore_offsets(mesh, make_tube(200, 300, bumpy), axes({0}), {}, ctx);
        return std::pair(std::move(mesh.positions), std::move(result));
    };
    const auto [positions, result] = run(1);
    for (const unsigned threads : {2u, 7u}) {
        const auto [again, same] = run(threads);
        EXPECT_EQ(again, positions);
        EXPECT_EQ(same.offsets, result.offsets);
        EXPECT_EQ(same.report, result.report);
    }
}

TEST(RestoreOffsets, RejectInvalidInput) {
    QuadMesh mesh = plain_tube();
    const PolygonMesh original = make_tube(60, 60, bumpy);
    EXPECT_EQ(error_of([&] { restore_offsets(mesh, original, axes({0}), {.reach = 0}); }),
              "restore: reach must be between 0.001 and 10, but is 0");
    PolygonMesh broken = original;
    broken.positions[7].x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(error_of([&] { restore_offsets(mesh, broken, axes({0})); }).find("7"), std::string::npos);
    mesh.quads[3][1] = 1'000'000;
    EXPECT_NE(error_of([&] { restore_offsets(mesh, original, axes({0})); }).find("3"), std::string::npos);
}

}  // namespace
}  // namespace coppice
