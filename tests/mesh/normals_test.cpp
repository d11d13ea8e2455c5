#include "coppice/mesh/normals.h"

#include <gtest/gtest.h>

#include <vector>

namespace coppice {
namespace {

// Two faces at a right angle, of 1 m^2 and 4 m^2, that share the edge along y.
const std::vector<Vec3> kFold{{0, 0, 0}, {0, 1, 0}, {-1, 1, 0}, {-1, 0, 0}, {0, 1, -4}, {0, 0, -4}};

TEST(SmoothNormals, WeightsFacesByTheirArea) {
    const std::vector<Quad> quads{{0, 1, 2, 3}, {0, 5, 4, 1}};  // outward: +z, +x
    const Buffer<Vec3> n = smooth_normals(kFold, quads);
    EXPECT_EQ(n[2], (Vec3{0, 0, 1}));
    EXPECT_EQ(n[5], (Vec3{1, 0, 0}));
    // (4, 0, 1) divided by its length.
    EXPECT_NEAR(n[0].x, 0.970143f, 1e-6f);
    EXPECT_NEAR(n[0].z, 0.242536f, 1e-6f);
}

TEST(SmoothNormals, OfTrianglesMatchThoseOfQuads) {
    const TriMesh mesh{{kFold.begin(), kFold.end()}, {{0, 1, 2}, {0, 2, 3}}, {}};
    for (const std::size_t v : {0, 1, 2, 3}) EXPECT_EQ(smooth_normals(mesh)[v], (Vec3{0, 0, 1}));
}

TEST(SmoothNormals, DegenerateFacesHaveANormalUp) {
    const std::vector<Vec3> still(4, Vec3{1, 2, 3});
    for (const Vec3 n : smooth_normals(still, std::vector<Quad>{{0, 1, 2, 3}})) EXPECT_EQ(n, (Vec3{0, 0, 1}));
}

}  // namespace
}  // namespace coppice
