#include "coppice/pipeline/remesh/quadrangulate_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"

namespace coppice {
namespace {

const Buffer<Vec3> kOctahedron{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
const std::vector<Triangle> kFaces{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                   {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};

QuadMesh make_mesh(const Buffer<Vec3>& positions, const QuadPatch& patch) {
    QuadMesh out;
    out.positions = positions;
    out.quads.assign(patch.quads.begin(), patch.quads.end());
    return out;
}

TEST(Quadrangulate, SingleTriangleBecomesThreeQuads) {
    Buffer<Vec3> x = kOctahedron;
    const std::vector<std::uint8_t> alone(kFaces.size(), 1);
    QuadPatch patch = quadrangulate(kFaces, {}, x);
    split_pairs(patch, alone, x);
    ASSERT_EQ(patch.quads.size(), 3 * kFaces.size());
    const TopologyReport t = topology(make_mesh(x, patch));
    EXPECT_TRUE(t.watertight());
    EXPECT_EQ(t.euler, 2);
    EXPECT_NEAR(shape(make_mesh(x, patch)).signed_volume, 4.0 / 3, 1e-6);
    std::vector<int> count(kFaces.size(), 0);
    for (std::size_t q = 0; q < patch.quads.size(); ++q) {
        const Triangle& own = kFaces[patch.triangle[q]];
        EXPECT_NE(std::find(own.begin(), own.end(), patch.quads[q][0]), own.end());
        ++count[patch.triangle[q]];
    }
    EXPECT_EQ(count, std::vector<int>(kFaces.size(), 3));
}

// A strip of three squares.
TEST(Quadrangulate, SplitsOnlyPairsWithAMarkedTriangle) {
    Buffer<Vec3> x;
    for (int i = 0; i < 4; ++i) {
        x.push_back({static_cast<float>(i), 0, 0});
        x.push_back({static_cast<float>(i), 1, 0});
    }
    std::vector<Triangle> strip;
    for (std::uint32_t i = 0; i < 6; i += 2) {
        strip.push_back({i, i + 2, i + 3});
        strip.push_back({i, i + 3, i + 1});
    }
    QuadPatch patch = quadrangulate(strip, {}, x);
    ASSERT_EQ(patch.quads.size(), 12u);
    std::vector<std::uint8_t> alone(strip.size(), 0);
    alone[3] = 1;
    const QuadPatch before = patch;
    split_pairs(patch, alone, x);
    ASSERT_EQ(patch.quads.size(), 14u);
    EXPECT_TRUE(std::equal(before.quads.begin(), before.quads.begin() + 4, patch.quads.begin()));
    EXPECT_TRUE(std::equal(before.quads.end() - 4, before.quads.end(), patch.quads.end() - 4));
    EXPECT_NEAR(shape(make_mesh(x, patch)).area, 3, 1e-6);
    EXPECT_EQ(shape(make_mesh(x, patch)).inverted_faces, 0u);
}

// A strip of six equilateral triangles, the middle pair of which is best: joined first, it leaves two single
// triangles, which a path through all pairs joins.
TEST(Quadrangulate, JoinsSingleTrianglesAlongPaths) {
    const float h = std::sqrt(0.75f);
    Buffer<Vec3> x{{0, 0, 0}, {0.5f, h, 0}, {1, 0, 0}, {1.5f, h, 0},
                   {2, 0, 0}, {2.5f, h, 0}, {3, 0, 0}, {3.5f, h, 0}};
    std::vector<Triangle> strip;
    for (std::uint32_t i = 0; i < 6; ++i)
        strip.push_back(i % 2 == 0 ? Triangle{i, i + 2, i + 1} : Triangle{i, i + 1, i + 2});
    x[2].y -= 0.05f;  // the second and third triangles become the best pair
    x[3].y += 0.05f;
    EXPECT_EQ(quadrangulate(strip, {}, x).quads.size(), 12u);
}

TEST(Quadrangulate, CoplanarPairBecomesFourQuads) {
    Buffer<Vec3> x{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const std::vector<Triangle> square{{0, 1, 2}, {0, 2, 3}};
    const QuadPatch patch = quadrangulate(square, {}, x);
    ASSERT_EQ(patch.quads.size(), 4u);
    EXPECT_EQ(x.size(), 9u);
    for (const Quad& q : patch.quads) EXPECT_NEAR(scaled_jacobian(q, x), 1, 1e-6);
}

TEST(Quadrangulate, UsesTheGivenEdgeMiddles) {
    Buffer<Vec3> x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5f, -0.1f, 0}};
    const std::vector<Triangle> one{{0, 1, 2}};
    const std::vector<EdgeMiddle> given{{1, 0, 3}};
    const QuadPatch patch = quadrangulate(one, given, x);
    ASSERT_EQ(patch.quads.size(), 3u);
    EXPECT_EQ(x.size(), 7u);  // two edge middles and one inner vertex
    EXPECT_EQ(patch.quads[0][1], 3u);
}

TEST(Quadrangulate, DoesNotJoinTrianglesAcrossAnEdge) {
    Buffer<Vec3> x{
        {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0.1f, 1}};  // normals differ by more than a right angle
    const std::vector<Triangle> roof{{0, 1, 2}, {1, 0, 3}};
    EXPECT_EQ(quadrangulate(roof, {}, x).quads.size(), 6u);
}

}  // namespace
}  // namespace coppice
