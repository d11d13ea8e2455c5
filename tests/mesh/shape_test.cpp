#include "coppice/mesh/shape.h"

#include <gtest/gtest.h>

#include <numbers>

#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

double jacobian(std::vector<Vec3> x) {
    std::vector<std::uint32_t> face;
    for (std::uint32_t i = 0; i < x.size(); ++i) face.push_back(i);
    return scaled_jacobian(face, x);
}

TEST(Shape, BoxHasItsVolumeAndArea) {
    const ShapeReport s = shape(box({1, 1, 1}, {3, 4, 5}));
    EXPECT_DOUBLE_EQ(s.signed_volume, 2 * 3 * 4);
    EXPECT_DOUBLE_EQ(s.area, 2 * (2 * 3 + 3 * 4 + 4 * 2));
    EXPECT_EQ(s.inverted_faces, 0u);
    EXPECT_EQ(s.scaled_jacobian.n, 6u);
    EXPECT_DOUBLE_EQ(s.scaled_jacobian.min, 1);
    EXPECT_DOUBLE_EQ(s.scaled_jacobian.max, 1);
}

TEST(Shape, InvertedCubeHasNegativeVolume) { EXPECT_DOUBLE_EQ(shape(inverted(cube())).signed_volume, -1); }

TEST(Shape, VolumeIsExactFarFromTheOrigin) {
    EXPECT_DOUBLE_EQ(shape(box({4e6f, 4e6f, 0}, {4e6f + 1, 4e6f + 1, 1})).signed_volume, 1);
}

TEST(Shape, TorusVolumeApproximatesPappus) {
    // 2 pi^2 R r^2; an inscribed polygon of 64 corners has 0.9984 of its circle's area.
    EXPECT_NEAR(shape(torus(64, 256, 1, 3)).signed_volume / (2 * std::numbers::pi * std::numbers::pi * 3),
                0.9984, 5e-4);
}

TEST(ScaledJacobian, IsTheMinimumSine) {
    EXPECT_DOUBLE_EQ(jacobian({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}), 1);
    EXPECT_NEAR(jacobian({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {1, 1, 0}}), std::numbers::sqrt2 / 2,
                1e-6);  // 45 degrees
    EXPECT_NEAR(jacobian({{0, 0, 0}, {2, 0, 0}, {1, std::numbers::sqrt3_v<float>, 0}}), 1, 1e-6);
    EXPECT_NEAR(jacobian({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), std::numbers::sqrt2 / std::numbers::sqrt3, 1e-6);
}

TEST(ScaledJacobian, IsNotPositiveForFoldedFaces) {
    EXPECT_LT(jacobian({{0, 0, 0}, {1, 0, 0}, {0.2f, 0.2f, 0}, {0, 1, 0}}), 0);  // an arrow head
    EXPECT_EQ(jacobian({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}}), -1);       // no area
    EXPECT_EQ(jacobian({{0, 0, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}}), -1);       // an edge of length zero
    EXPECT_LT(jacobian({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}), 0);
    EXPECT_EQ(shape(polygons({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}})).inverted_faces, 1u);
}

TEST(FanCorner, SplitsQuadsAlongTheShorterDiagonal) {
    const std::vector<std::uint32_t> face{0, 1, 2, 3};
    EXPECT_EQ(fan_corner(face, std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}), 0u);
    EXPECT_EQ(fan_corner(face, std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {2, 2, 0}, {0, 1, 0}}), 1u);
    EXPECT_EQ(fan_corner(face, std::vector<Vec3>{{0, 0, 0}, {3, 0, 0}, {1, 1, 0}, {0, 3, 0}}), 0u);
}

TEST(Shape, EmptyMeshHasAnEmptyReport) { EXPECT_EQ(shape(PolygonMesh{}), ShapeReport{}); }

TEST(Shape, IsBitIdenticalForAnyNumberOfThreads) {
    const PolygonMesh m = torus(200, 300, 1, 3);
    const ShapeReport one = shape(m, {.threads = 1});
    EXPECT_EQ(shape(m, {.threads = 2}), one);
    EXPECT_EQ(shape(m, {.threads = 7}), one);
}

}  // namespace
}  // namespace coppice
