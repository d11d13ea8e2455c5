#include "coppice/subdivision/halfedge_internal.h"

#include <gtest/gtest.h>

#include "coppice/base/error.h"
#include "coppice/subdivision/catmull_clark.h"
#include "subdivision/cages.h"
#include "subdivision/match.h"

namespace coppice {
namespace {

TEST(Halfedge, CountsGrowAsTheRuleSays) {
    HalfedgeMesh mesh = build_halfedges(hub_cage(3).points, hub_cage(3).quads);
    EXPECT_EQ(mesh.edge_count, 12);
    mesh = refine_halfedges(mesh);
    EXPECT_EQ(mesh.vertex_count(), 8 + 6 + 12);
    EXPECT_EQ(mesh.edge_count, 2 * 12 + 24);
    EXPECT_EQ(mesh.face_count(), 24);
}

TEST(Halfedge, ACubeByHand) {
    // The cube [-1, 1]^3: face points at distance 1, edge points at (2 * 1 + 2 * 1/2) / 4 = 3/4 along two
    // axes; a corner keeps (3 - 3) / 3 of itself and gets 1/3 mean of face points (1/3) + 2/3 mean of
    // midpoints (2/3) = 5/9 per axis.
    const std::vector<Vec3> points = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                      {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
    const std::vector<Quad> quads = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                     {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    const HalfedgeMesh mesh = refine_halfedges(build_halfedges(points, quads));
    for (std::size_t v = 0; v < 8; ++v) {
        EXPECT_NEAR(mesh.points[v].x, 5.0 / 9 * static_cast<double>(points[v].x), 1e-12);
        EXPECT_NEAR(mesh.points[v].z, 5.0 / 9 * static_cast<double>(points[v].z), 1e-12);
    }
    EXPECT_NEAR(mesh.points[8 + 1].z, 1, 1e-12);
    for (std::size_t e = 14; e < 26; ++e) EXPECT_NEAR(length(mesh.points[e]), 0.75 * std::sqrt(2.0), 1e-12);
}

TEST(Halfedge, TwinsAndEdgesStayConsistent) {
    for (const auto& [name, cage] : cage_zoo()) {
        SCOPED_TRACE(name);
        const HalfedgeMesh mesh =
            refine_halfedges(refine_halfedges(build_halfedges(cage.points, cage.quads)));
        for (std::size_t h = 0; h < mesh.twin.size(); ++h) {
            if (mesh.twin[h] == HalfedgeMesh::kBoundary) continue;
            const auto twin = static_cast<std::size_t>(mesh.twin[h]);
            EXPECT_EQ(mesh.twin[twin], static_cast<std::int32_t>(h));
            EXPECT_EQ(mesh.edge[twin], mesh.edge[h]);
            EXPECT_EQ(mesh.vertex[twin], mesh.vertex[(h & ~std::size_t{3}) | ((h + 1) & 3)]);
        }
    }
}

TEST(Halfedge, GivesTheSurfaceOfPatchRefinement) {
    for (const auto& [name, cage] : cage_zoo()) {
        HalfedgeMesh reference = build_halfedges(cage.points, cage.quads);
        for (int levels = 1; levels <= 3; ++levels) {
            SCOPED_TRACE(name + ", levels " + std::to_string(levels));
            reference = refine_halfedges(reference);
            const QuadMesh expected = to_quads(reference);
            const PatchRefinement patches(cage.quads, cage.vertex_count(), levels);
            const Buffer<Vec3> points = patches.refine(cage.points);
            ASSERT_EQ(points.size(), expected.positions.size());
            const auto map = match_points(points, expected.positions, 3e-5f);
            ASSERT_EQ(std::count(map.begin(), map.end(), points.size()), 0);
            EXPECT_EQ(canonical_quads(patches.quads(), map), canonical_quads(expected.quads));
        }
    }
}

TEST(Halfedge, RefusesTwoQuadsInOneDirection) {
    const std::vector<Vec3> points(6);
    const std::vector<Quad> quads = {{0, 1, 2, 3}, {0, 1, 4, 5}};
    EXPECT_THROW(build_halfedges(points, quads), InvalidInput);
}

}  // namespace
}  // namespace coppice
