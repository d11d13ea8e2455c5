#include "coppice/measure/volume_report.h"

#include <gtest/gtest.h>

#include <numbers>

#include "coppice/measure/axes.h"
#include "coppice/mesh/shape.h"
#include "measure/support.h"
#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

constexpr double kPi = std::numbers::pi;

VolumeReport report(const PolygonMesh& mesh, const Skeleton& s, EndShape base = EndShape::flat) {
    const ConeUnion solid(s, mesh.origin, base, EndShape::round);
    const AxesFound axes = judge_axes(mesh, s, solid, EndShape::round);
    return volume_report(SurfaceTree(mesh), shape(mesh).signed_volume, s, solid, axes.is_deep);
}

TEST(VolumeReport, OfAnExactSurfaceHasNothingMissing) {
    // Rings of 64 sides have (64 / 2 pi) sin(2 pi / 64) = 0.9984 of the circle's area.
    const Skeleton pole({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {0.5f, 0.5f});
    const VolumeReport r = report(capsule(64, 16, 0.5f, 0, 10), pole, EndShape::round);
    EXPECT_NEAR(r.cones, kPi * 2.5 + kPi / 6, 1e-9);
    EXPECT_NEAR(r.ratio(), 0.9984, 0.001);
    EXPECT_EQ(r.missing, 0);
    EXPECT_TRUE(r.lumps.empty());
    EXPECT_TRUE(r.complete());
}

TEST(VolumeReport, MeasuresAMissingBall) {
    // A ball of radius 5 in the middle of a thin line; the surface of the line ignores the ball.
    const Skeleton s({kRoot, NodeId(0), NodeId(1), NodeId(2), NodeId(3)},
                     {{0, 0, -50}, {0, 0, -0.1f}, {0, 0, 0}, {0, 0, 0.1f}, {0, 0, 50}}, {1, 1, 5, 1, 1},
                     {1000, 0, 0});
    PolygonMesh thin = capsule(32, 64, 1, -50, 50);
    thin.origin = {1000, 0, 0};
    const VolumeReport r = report(thin, s);
    // The cones on both sides of node 2 are thin discs; the half balls beyond them form the ball. Beyond 2.5
    // from the surface of radius 1, at most the ball outside a cylinder of radius 3.5: 4 pi / 3 (25
    // - 12.25)^1.5.
    EXPECT_GT(r.missing, 0.2 * r.cones);
    EXPECT_LT(r.missing, 4 * kPi / 3 * 46);
    EXPECT_FALSE(r.complete());
    ASSERT_EQ(r.lumps.size(), 1u);
    EXPECT_NEAR(r.lumps[0].volume, r.missing, 1e-9 * r.missing);
    EXPECT_EQ(r.lumps[0].segments, 2u);
    EXPECT_TRUE(r.lumps[0].node == NodeId(2) || r.lumps[0].node == NodeId(3));
    EXPECT_NEAR(r.lumps[0].place.x, 1000, 1e-9);
}

TEST(VolumeReport, LumpsAreSortedBySize) {
    // A trunk that exists, and two twigs of it that are missing, the second of two segments.
    const Skeleton s({kRoot, NodeId(0), NodeId(1), NodeId(2), NodeId(1), NodeId(2), NodeId(5)},
                     {{0, 0, 0}, {0, 0, 3}, {0, 0, 6}, {0, 0, 10}, {5, 0, 3}, {-5, 0, 6}, {-9, 0, 6}},
                     {1, 1, 1, 1, 0.2f, 0.2f, 0.2f});
    const VolumeReport r = report(capsule(64, 32, 1, 0, 10), s, EndShape::round);
    ASSERT_EQ(r.lumps.size(), 2u);
    EXPECT_EQ(r.lumps[0].segments, 2u);
    EXPECT_EQ(r.lumps[1].segments, 1u);
    EXPECT_EQ(r.lumps[1].node, NodeId(4));
    // 8 m and 4 m beyond the trunk's surface, minus a tenth of a metre that is too near to it, and half a
    // ball.
    const double area = kPi * 0.04, end = 2 * kPi / 3 * 0.008;
    EXPECT_NEAR(r.lumps[0].volume, area * 7.9 + end, 0.02);
    EXPECT_NEAR(r.lumps[1].volume, area * 3.9 + end, 0.02);
}

TEST(VolumeReport, EmptySurfaceHasEverythingMissing) {
    const Skeleton pole({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {0.5f, 0.5f});
    const VolumeReport r = report(PolygonMesh{}, pole);
    EXPECT_EQ(r.missing_percent(), 100);
    EXPECT_FALSE(r.complete());
}

}  // namespace
}  // namespace coppice
