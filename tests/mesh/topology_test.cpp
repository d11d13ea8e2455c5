#include "coppice/mesh/topology.h"

#include <gtest/gtest.h>

#include <limits>

#include "coppice/base/error.h"
#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

TEST(Topology, CubeIsSound) {
    const TopologyReport t = topology(cube());
    EXPECT_TRUE(t.watertight());
    EXPECT_EQ(t.vertices, 8u);
    EXPECT_EQ(t.edges, 12u);
    EXPECT_EQ(t.faces, 6u);
    EXPECT_EQ(t.quads, 6u);
    EXPECT_EQ(t.components, 1u);
    EXPECT_EQ(t.euler, 2);
    EXPECT_EQ(t.irregular_vertices, 8u);  // three faces at every corner
    EXPECT_DOUBLE_EQ(t.quads_percent(), 100);
    EXPECT_DOUBLE_EQ(t.irregular_percent(), 100);
}

TEST(Topology, InvertedCubeIsSound) { EXPECT_EQ(topology(inverted(cube())), topology(cube())); }

TEST(Topology, TorusIsRegularAndHasEulerNumberZero) {
    const TopologyReport t = topology(torus(12, 30, 1, 3));
    EXPECT_TRUE(t.watertight());
    EXPECT_EQ(t.euler, 0);
    EXPECT_EQ(t.irregular_vertices, 0u);
    EXPECT_EQ(t.edges, 2u * 12 * 30);
}

TEST(Topology, OpenTubeHasAnOpenEdgePerSideAtBothEnds) {
    const TopologyReport t = topology(tube(8, 3, 1, 5));
    EXPECT_FALSE(t.watertight());
    EXPECT_EQ(t.open_edges, 16u);
    EXPECT_EQ(t.non_manifold_vertices, 0u);  // half a fan counts as one fan
    EXPECT_EQ(t.euler, 0);
    EXPECT_EQ(t.irregular_vertices, 16u);
}

TEST(Topology, TwoCubesAreTwoComponents) {
    const TopologyReport t = topology(both(cube(), box({5, 0, 0}, {6, 1, 1})));
    EXPECT_TRUE(t.watertight());
    EXPECT_EQ(t.components, 2u);
    EXPECT_EQ(t.euler, 4);
}

TEST(Topology, CubesThatShareAVertexHaveANonManifoldVertex) {
    PolygonMesh m = both(cube(), box({1, 1, 1}, {2, 2, 2}));
    for (auto& v : m.corners)
        v = v == 8 ? 7 : v;  // vertex 8, the low corner of the second cube, becomes vertex 7 of the first
    const TopologyReport t = topology(m);
    EXPECT_FALSE(t.watertight());
    EXPECT_EQ(t.non_manifold_vertices, 1u);
    EXPECT_EQ(t.non_manifold_edges, 0u);
    EXPECT_EQ(t.vertices, 15u);   // vertex 8 is no longer used
    EXPECT_EQ(t.components, 2u);  // a common vertex does not connect components
}

TEST(Topology, CubesThatShareAnEdgeHaveANonManifoldEdge) {
    PolygonMesh m = both(cube(), box({1, 1, 0}, {2, 2, 1}));
    for (auto& v : m.corners) v = v == 8 ? 3 : v == 12 ? 7 : v;
    const TopologyReport t = topology(m);
    EXPECT_EQ(t.non_manifold_edges, 1u);
    EXPECT_EQ(t.open_edges, 0u);
    EXPECT_EQ(t.edges, 23u);
    EXPECT_EQ(t.components, 1u);
    EXPECT_FALSE(t.watertight());
}

TEST(Topology, MoebiusStripHasOneMisorientedEdge) {
    const TopologyReport t = topology(moebius(12));
    EXPECT_EQ(t.misoriented_edges, 1u);
    EXPECT_EQ(t.open_edges, 24u);
    EXPECT_EQ(t.euler, 0);
    EXPECT_EQ(t.components, 1u);
}

TEST(Topology, ReversedFaceOfACubeHasFourMisorientedEdges) {
    PolygonMesh m = cube();
    std::swap(m.corners[1], m.corners[3]);
    const TopologyReport t = topology(m);
    EXPECT_EQ(t.misoriented_edges, 4u);
    EXPECT_EQ(t.open_edges, 0u);
    EXPECT_FALSE(t.watertight());
}

TEST(Topology, FaceWithARepeatedVertexHasAnAdditionalEdge) {
    // A triangle written as a quad: the edge from vertex 0 to itself belongs to one face.
    const TopologyReport t = topology(polygons({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1, 2}}));
    EXPECT_EQ(t.edges, 4u);
    EXPECT_EQ(t.open_edges, 4u);
    EXPECT_EQ(t.non_manifold_vertices, 0u);
}

TEST(Topology, VertexOfManyFacesHasOneFanOrTwo) {
    // Two discs of 5,000 triangles each about the same vertex.
    PolygonMesh m;
    const std::uint32_t n = 5000;
    m.positions.resize(2 * n + 1);
    for (std::uint32_t i = 0; i < n; ++i) m.add_face(std::vector{2 * n, i, (i + 1) % n});
    EXPECT_EQ(topology(m).non_manifold_vertices, 0u);
    for (std::uint32_t i = 0; i < n; ++i) m.add_face(std::vector{2 * n, n + i, n + (i + 1) % n});
    EXPECT_EQ(topology(m).non_manifold_vertices, 1u);
    EXPECT_EQ(topology(m).components, 2u);
}

TEST(Topology, EmptyMeshIsNotSound) {
    const TopologyReport t = topology(PolygonMesh{});
    EXPECT_FALSE(t.watertight());
    EXPECT_EQ(t.components, 0u);
    EXPECT_DOUBLE_EQ(t.quads_percent(), 0);
}

TEST(Topology, QuadMeshMatchesPolygonMesh) {
    const PolygonMesh m = torus(8, 9, 1, 3);
    QuadMesh q;
    q.positions = m.positions;
    for (std::uint32_t f = 0; f < m.face_count(); ++f) {
        q.quads.push_back({m.face(f)[0], m.face(f)[1], m.face(f)[2], m.face(f)[3]});
    }
    EXPECT_EQ(topology(q), topology(m));
}

TEST(Topology, IsBitIdenticalForAnyNumberOfThreads) {
    // Large enough for many ranges, with a seam, a hole and two components.
    PolygonMesh m = both(torus(200, 400, 1, 3), tube(100, 300, 0.1f, 1));
    std::swap(m.corners[400], m.corners[402]);
    const TopologyReport one = topology(m, {.threads = 1});
    EXPECT_EQ(one.components, 2u);
    EXPECT_EQ(one.misoriented_edges, 4u);
    EXPECT_EQ(one.open_edges, 200u);
    EXPECT_EQ(topology(m, {.threads = 2}), one);
    EXPECT_EQ(topology(m, {.threads = 7}), one);
}

TEST(Validate, RejectsInvalidMeshes) {
    EXPECT_NO_THROW(validate(cube()));
    PolygonMesh m = cube();
    m.positions[3].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(validate(m), InvalidInput);
    m.positions[3].y = std::numeric_limits<float>::infinity();
    EXPECT_THROW(validate(m), InvalidInput);
    EXPECT_THROW(validate(polygons({{}, {}, {}}, {{0, 1, 3}})), InvalidInput);
    EXPECT_THROW(validate(polygons({{}, {}, {}}, {{0, 1}})), InvalidInput);
    EXPECT_THROW(validate(polygons({}, {{0, 1, 2}})), InvalidInput);
}

}  // namespace
}  // namespace coppice
