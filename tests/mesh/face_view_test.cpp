#include "coppice/mesh/face_view.h"

#include <gtest/gtest.h>

#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

std::vector<std::uint32_t> corners(const FaceView& faces, std::uint32_t f) {
    return {faces.face(f).begin(), faces.face(f).end()};
}

TEST(FaceView, MatchesForQuadsAndPolygons) {
    QuadMesh quads;
    quads.positions = cube().positions;
    quads.quads.push_back({0, 2, 3, 1});
    quads.quads.push_back({4, 5, 7, 6});
    const PolygonMesh polygons = to_polygons(quads);
    const FaceView a(quads), b(polygons);
    ASSERT_EQ(a.size(), 2u);
    ASSERT_EQ(b.size(), 2u);
    for (std::uint32_t f = 0; f < 2; ++f) EXPECT_EQ(corners(a, f), corners(b, f));
    EXPECT_EQ(corners(a, 1), (std::vector<std::uint32_t>{4, 5, 7, 6}));
    EXPECT_EQ(a.first(1).size(), 1u);
    EXPECT_EQ(FaceView(QuadMesh{}).size(), 0u);
}

TEST(FaceView, ComputesTheBoxesOfFaces) {
    const PolygonMesh mesh = polygons({{0, 0, 0}, {2, 0, 1}, {1, 3, 0}, {9, 9, 9}}, {{0, 1, 2}});
    EXPECT_EQ(FaceView(mesh).box(0).low, Vec3(0, 0, 0));
    EXPECT_EQ(FaceView(mesh).box(0).high, Vec3(2, 3, 1));
}

TEST(SomeFaces, PreservesTheOrderOfFacesAndVertices) {
    const PolygonMesh mesh = polygons({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}},
                                      {{0, 1, 2}, {0, 3, 2}, {4, 3, 2, 0}});
    const std::vector<std::uint32_t> faces{2, 1};
    const PolygonMesh part = some_faces(mesh, faces);
    // Vertex 1 is not used.
    ASSERT_EQ(part.positions.size(), 4u);
    EXPECT_EQ(part.positions[1], Vec3(2, 0, 0));
    ASSERT_EQ(part.face_count(), 2u);
    EXPECT_EQ(corners(part, 0), (std::vector<std::uint32_t>{3, 2, 1, 0}));
    EXPECT_EQ(corners(part, 1), (std::vector<std::uint32_t>{0, 2, 1}));
    EXPECT_EQ(some_faces(mesh, {}).face_count(), 0u);
}

}  // namespace
}  // namespace coppice
