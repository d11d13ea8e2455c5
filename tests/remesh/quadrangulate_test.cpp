#include "coppice/remesh/quadrangulate.h"

#include <gtest/gtest.h>

#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"

namespace coppice {
namespace {

const Buffer<Vec3> kOctahedron{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
const std::vector<Triangle> kFaces{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                   {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};

QuadMesh mesh_of(const Buffer<Vec3>& positions, const QuadPatch& patch) {
    QuadMesh out;
    out.positions = positions;
    out.quads.assign(patch.quads.begin(), patch.quads.end());
    return out;
}

TEST(Quadrangulate, ATriangleAloneBecomesThreeQuadsInItsPlane) {
    Buffer<Vec3> x = kOctahedron;
    const std::vector<std::uint8_t> alone(kFaces.size(), 1);
    const QuadPatch patch = quadrangulate(kFaces, alone, {}, x);
    ASSERT_EQ(patch.quads.size(), 3 * kFaces.size());
    const TopologyReport t = topology(mesh_of(x, patch));
    EXPECT_TRUE(t.sound());
    EXPECT_EQ(t.euler, 2);
    EXPECT_NEAR(shape(mesh_of(x, patch)).signed_volume, 4.0 / 3, 1e-6);
    for (std::size_t q = 0; q < patch.quads.size(); ++q) EXPECT_EQ(patch.triangle[q], q / 3);
}

TEST(Quadrangulate, FlatNeighboursBecomeFourQuads) {
    Buffer<Vec3> x{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const std::vector<Triangle> square{{0, 1, 2}, {0, 2, 3}};
    const std::vector<std::uint8_t> alone(2, 0);
    const QuadPatch patch = quadrangulate(square, alone, {}, x);
    ASSERT_EQ(patch.quads.size(), 4u);
    EXPECT_EQ(x.size(), 9u);
    for (const Quad& q : patch.quads) EXPECT_NEAR(scaled_jacobian(q, x), 1, 1e-6);
}

TEST(Quadrangulate, TakesTheMiddlesThatAreGiven) {
    Buffer<Vec3> x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5f, -0.1f, 0}};
    const std::vector<Triangle> one{{0, 1, 2}};
    const std::vector<std::uint8_t> alone(1, 0);
    const std::vector<EdgeMiddle> given{{1, 0, 3}};
    const QuadPatch patch = quadrangulate(one, alone, given, x);
    ASSERT_EQ(patch.quads.size(), 3u);
    EXPECT_EQ(x.size(), 7u);  // two middles and one within
    EXPECT_EQ(patch.quads[0][1], 3u);
}

TEST(Quadrangulate, DoesNotJoinTrianglesAcrossAnEdge) {
    Buffer<Vec3> x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0.1f, 1}};  // a right angle and more between them
    const std::vector<Triangle> roof{{0, 1, 2}, {1, 0, 3}};
    const std::vector<std::uint8_t> alone(2, 0);
    EXPECT_EQ(quadrangulate(roof, alone, {}, x).quads.size(), 6u);
}

}  // namespace
}  // namespace coppice
