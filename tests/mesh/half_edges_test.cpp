#include "coppice/mesh/half_edges.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

std::vector<std::uint32_t> halves(const HalfEdges& edges, std::uint32_t a, std::uint32_t b) {
    const auto found = edges.halves(edges.find(a, b));
    return {found.begin(), found.end()};
}

/// Expects that the members agree with the corners of the mesh, and edges in the order of their vertices.
void expect_consistent(const PolygonMesh& mesh, const HalfEdges& edges) {
    ASSERT_EQ(edges.size(), mesh.corners.size());
    ASSERT_EQ(edges.face_count(), mesh.face_count());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto face = mesh.face(f);
        for (std::uint32_t k = 0; k < face.size(); ++k) {
            const std::uint32_t h = mesh.first[f] + k;
            EXPECT_EQ(edges.face(h), f);
            EXPECT_EQ(edges.origin(h), face[k]);
            EXPECT_EQ(edges.target(h), face[(k + 1) % face.size()]);
            EXPECT_EQ(edges.next(h), mesh.first[f] + (k + 1) % face.size());
            EXPECT_EQ(edges.is_backward(h), edges.origin(h) > edges.target(h));
        }
    }
    std::size_t all = 0;
    for (std::uint32_t e = 0; e < edges.edge_count(); ++e) {
        if (e > 0) {
            EXPECT_LT(edges.ends(e - 1), edges.ends(e));
        }
        EXPECT_EQ(edges.find(edges.ends(e)[1], edges.ends(e)[0]), e);
        for (const std::uint32_t h : edges.halves(e)) {
            ++all;
            EXPECT_EQ(edges.edge(h), e);
            EXPECT_EQ(std::min(edges.origin(h), edges.target(h)), edges.ends(e)[0]);
            EXPECT_EQ(std::max(edges.origin(h), edges.target(h)), edges.ends(e)[1]);
            const std::uint32_t twin = edges.twin(h);
            if (twin == kNoIndex) continue;
            EXPECT_EQ(edges.twin(twin), h);
            EXPECT_EQ(edges.origin(twin), edges.target(h));
            EXPECT_EQ(edges.target(twin), edges.origin(h));
        }
    }
    EXPECT_EQ(all, edges.size());
}

TEST(HalfEdges, OfClosedSurfacesHaveTwins) {
    // Euler: V - E + F = 2 for the cube, 0 for the torus.
    for (const auto& [mesh, edge_count] : {std::pair{cube(), 12u}, {torus(12, 30, 1, 3), 720u}}) {
        const HalfEdges edges(mesh);
        expect_consistent(mesh, edges);
        EXPECT_EQ(edges.edge_count(), edge_count);
        EXPECT_TRUE(edges.irregular().empty());
        for (std::uint32_t h = 0; h < edges.size(); ++h) EXPECT_NE(edges.twin(h), kNoIndex);
    }
}

TEST(HalfEdges, OfQuadsAndTrianglesAreThoseOfPolygons) {
    const std::vector<Quad> quads{{0, 1, 2, 3}, {1, 4, 5, 2}, {6, 7, 4, 1}};
    const std::vector<Triangle> triangles{{0, 1, 2}, {2, 1, 3}, {3, 1, 4}, {5, 4, 1}};
    PolygonMesh of_quads, of_triangles;
    of_quads.positions.resize(9);
    of_triangles.positions.resize(6);
    for (const Quad& q : quads) of_quads.add_face(q);
    for (const Triangle& t : triangles) of_triangles.add_face(t);
    expect_consistent(of_quads, HalfEdges(quads, 9));
    expect_consistent(of_triangles, HalfEdges(triangles, 6));
    EXPECT_TRUE(std::ranges::equal(HalfEdges(quads, 9).sides(), HalfEdges(of_quads).sides()));
    EXPECT_TRUE(std::ranges::equal(HalfEdges(triangles, 6).pairs(), HalfEdges(of_triangles).pairs()));
    EXPECT_EQ(HalfEdges(quads, 9).vertex_count(), 9u);  // vertex 8 has no faces
    for (std::uint32_t h = 0; h < 12; ++h) {
        EXPECT_EQ(next_half_edge<4>(h), HalfEdges(of_quads).next(h));
        EXPECT_EQ(previous_half_edge<4>(next_half_edge<4>(h)), h);
        EXPECT_EQ(next_half_edge<3>(h), HalfEdges(of_triangles).next(h));
        EXPECT_EQ(previous_half_edge<3>(next_half_edge<3>(h)), h);
    }
}

TEST(HalfEdges, AtBordersHaveNoTwin) {
    // A quad and a triangle with the common edge 1-2.
    PolygonMesh mesh = polygons(std::vector<Vec3>(5), {{0, 1, 2, 3}, {2, 1, 4}});
    const HalfEdges edges(mesh);
    expect_consistent(mesh, edges);
    EXPECT_EQ(edges.edge_count(), 6u);
    EXPECT_EQ(edges.twin(1), 4u);
    EXPECT_EQ(halves(edges, 1, 2), (std::vector{1u, 4u}));
    EXPECT_EQ(halves(edges, 0, 3), std::vector{3u});  // backward
    EXPECT_EQ(edges.twin(3), kNoIndex);
    EXPECT_TRUE(edges.irregular().empty());
    EXPECT_EQ(edges.find(0, 4), kNoIndex);
}

TEST(HalfEdges, OfANonManifoldEdgeHaveNoTwins) {
    PolygonMesh mesh = polygons(std::vector<Vec3>(5), {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
    const HalfEdges edges(mesh);
    expect_consistent(mesh, edges);
    EXPECT_EQ(edges.edge_count(), 7u);
    EXPECT_EQ(halves(edges, 0, 1), (std::vector{0u, 3u, 6u}));
    EXPECT_TRUE(std::ranges::equal(edges.irregular(), std::vector{0u, 3u, 6u}));
    for (std::uint32_t h = 0; h < edges.size(); ++h) EXPECT_EQ(edges.twin(h), kNoIndex);
}

TEST(HalfEdges, OfAFlippedNeighbourHaveNoTwins) {
    PolygonMesh mesh = cube();
    std::swap(mesh.corners[1], mesh.corners[3]);  // the first face becomes 0 1 3 2
    const HalfEdges edges(mesh);
    expect_consistent(mesh, edges);
    EXPECT_EQ(edges.irregular().size(), 8u);  // two half-edges for each of its sides
    EXPECT_EQ(halves(edges, 0, 1).size(), 2u);
    for (std::uint32_t h = 0; h < 4; ++h) EXPECT_EQ(edges.twin(h), kNoIndex);
}

TEST(HalfEdges, FromAVertexToItselfAreForward) {
    PolygonMesh mesh = polygons(std::vector<Vec3>(4), {{0, 0, 1, 2}, {2, 1, 3}});
    const HalfEdges edges(mesh);
    expect_consistent(mesh, edges);
    EXPECT_EQ(halves(edges, 0, 0), std::vector{0u});
    EXPECT_EQ(edges.twin(2), 4u);
}

TEST(HalfEdges, OfNothing) {
    EXPECT_EQ(HalfEdges().edge_count(), 0u);
    EXPECT_EQ(HalfEdges(std::span<const Quad>(), 3).edge_count(), 0u);
    const HalfEdges edges{PolygonMesh{}};
    EXPECT_EQ(edges.size(), 0u);
    EXPECT_EQ(edges.find(0, 1), kNoIndex);
}

TEST(HalfEdges, AreTheSameForAnyNumberOfThreads) {
    // 160,000 half-edges in several parts, one edge of 100 faces, and a vertex of 20,000 faces.
    PolygonMesh mesh = torus(200, 150, 1, 3);
    for (std::uint32_t i = 0; i < 100; ++i) mesh.add_face(std::vector{7u, 8u, 300 + i});
    for (std::uint32_t i = 0; i < 20000; ++i) mesh.add_face(std::vector{i, i + 1, 25000u});
    const HalfEdges one(mesh, {.threads = 1});
    expect_consistent(mesh, one);
    EXPECT_EQ(halves(one, 7, 8).size(), 103u);
    for (const unsigned threads : {2u, 7u}) {
        const HalfEdges many(mesh, {.threads = threads});
        EXPECT_TRUE(std::ranges::equal(one.sides(), many.sides()));
        EXPECT_TRUE(std::ranges::equal(one.pairs(), many.pairs()));
        EXPECT_TRUE(std::ranges::equal(one.irregular(), many.irregular()));
    }
}

}  // namespace
}  // namespace coppice
