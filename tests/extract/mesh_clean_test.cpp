#include "coppice/extract/mesh/mesh_clean.h"

#include <gtest/gtest.h>

#include <limits>

#include "coppice/base/error.h"
#include "coppice/mesh/topology.h"
#include "extract/mesh_support.h"

namespace coppice {
namespace {

using shapes::both;
using shapes::card;
using shapes::inverted;
using shapes::soup;
using shapes::tube;

PolygonMesh closed_tube() { return tube({0, 0, 0}, {0, 0, 2}, 0.1f); }

PolygonMesh as_polygons(const TriMesh& mesh) {
    PolygonMesh out;
    out.positions = mesh.positions;
    for (const Triangle& t : mesh.triangles) out.add_face(t);
    return out;
}

double volume(const TriMesh& m) {
    double sum = 0;
    for (const auto& [a, b, c] : m.triangles)
        sum += dot(Vec3d(m.positions[a]), cross(Vec3d(m.positions[b]), Vec3d(m.positions[c]))) / 6;
    return sum;
}

TEST(MeshClean, SoundMeshIsUnchanged) {
    const CleanMeshResult r = clean_mesh(closed_tube());
    EXPECT_EQ(r.repairs, MeshRepairs{});
    // 16 x 20 quads and two fans of 16.
    EXPECT_EQ(r.mesh.triangles.size(), 672u);
    EXPECT_EQ(r.mesh.positions.size(), 338u);
    EXPECT_TRUE(topology(as_polygons(r.mesh)).watertight());
}

TEST(MeshClean, WeldsSplitVertices) {
    const PolygonMesh apart = soup(closed_tube());
    const CleanMeshResult r = clean_mesh(apart);
    EXPECT_EQ(r.mesh.positions.size(), 338u);
    EXPECT_EQ(r.repairs.welded, apart.positions.size() - 338);
    EXPECT_TRUE(topology(as_polygons(r.mesh)).watertight());
}

TEST(MeshClean, WeldToleranceIsRelativeToTheSizeOfTheMesh) {
    PolygonMesh m = soup(closed_tube());
    for (std::size_t v = 0; v < m.positions.size(); v += 2) m.positions[v].x += 1e-3f;
    EXPECT_GT(clean_mesh(m, {.weld = 1e-6f}).repairs.open_edges, 0u);
    // Vertices at intervals of 1/2000 of the size, welded at a hundredth.
    EXPECT_LT(clean_mesh(m, {.weld = 0.01f}).mesh.positions.size(), 500u);
}

// Cells of 1e-22 of the size have indices beyond 64 bits: a regression test, all vertices were merged into
// one.
TEST(MeshClean, SmallestWeldToleranceIsExact) {
    const PolygonMesh m = soup(closed_tube());
    for (const float weld : {0.0f, 1e-22f, 1e-30f})
        EXPECT_EQ(clean_mesh(m, {.weld = weld}).mesh.positions.size(), 338u);
}

TEST(MeshClean, RemovesDegenerateAndDuplicateFaces) {
    PolygonMesh m = closed_tube();
    m.add_face(std::vector<std::uint32_t>{0, 1, 1});
    m.add_face(std::vector<std::uint32_t>{336, 1, 0});  // the first triangle of the lower fan
    const CleanMeshResult r = clean_mesh(m);
    EXPECT_EQ(r.repairs.degenerate, 1u);
    EXPECT_EQ(r.repairs.duplicates, 1u);
    EXPECT_TRUE(topology(as_polygons(r.mesh)).watertight());
}

TEST(MeshClean, ReversesInwardComponents) {
    const PolygonMesh right = closed_tube();
    const CleanMeshResult r = clean_mesh(inverted(right));
    EXPECT_EQ(r.repairs.flipped, 672u);
    EXPECT_NEAR(volume(r.mesh), volume(clean_mesh(right).mesh), 1e-9);
    EXPECT_GT(volume(r.mesh), 0);
}

TEST(MeshClean, OrientsAdjacentFacesConsistently) {
    PolygonMesh m;
    const PolygonMesh right = closed_tube();
    m.positions = right.positions;
    for (std::uint32_t f = 0; f < right.face_count(); ++f) {
        std::vector<std::uint32_t> face(right.face(f).begin(), right.face(f).end());
        if (f % 3 == 0) std::reverse(face.begin(), face.end());
        m.add_face(face);
    }
    const CleanMeshResult r = clean_mesh(m);
    EXPECT_TRUE(topology(as_polygons(r.mesh)).watertight());
    EXPECT_NEAR(volume(r.mesh), volume(clean_mesh(right).mesh), 1e-9);
}

TEST(MeshClean, NonManifoldEdgesAreReportedAndPreserved) {
    PolygonMesh m = closed_tube();
    m.positions.push_back({1, 0, 1});
    m.add_face(std::vector<std::uint32_t>{0, 16, 338});  // a fin on the edge between two rings
    const CleanMeshResult r = clean_mesh(m);
    EXPECT_EQ(r.repairs.non_manifold_edges, 1u);
    EXPECT_EQ(r.repairs.open_edges, 2u);
    EXPECT_EQ(r.mesh.triangles.size(), 673u);
}

TEST(MeshClean, FlatComponentsAreLeaves) {
    PolygonMesh m = closed_tube();
    for (int i = 0; i < 5; ++i) m = both(m, card({1, 0, static_cast<float>(i)}, 0.1f));
    const CleanMeshResult r = clean_mesh(m);
    EXPECT_EQ(r.repairs.cards, 5u);
    EXPECT_EQ(r.repairs.card_faces, 10u);
    EXPECT_EQ(r.mesh.triangles.size(), 672u);
    EXPECT_EQ(clean_mesh(m, {.cards = false}).mesh.triangles.size(), 682u);
}

TEST(MeshClean, RejectsAMeshOfLeavesOnly) {
    EXPECT_THROW(
        {
            try {
                clean_mesh(both(card({0, 0, 0}, 1), card({0, 0, 1}, 1)));
            } catch (const InvalidInput& e) {
                EXPECT_NE(std::string(e.what()).find("there is no wood in it"), std::string::npos);
                throw;
            }
        },
        InvalidInput);
}

PolygonMesh with_groups() {
    PolygonMesh m = both(closed_tube(), card({1, 0, 0}, 0.1f));
    m.group_names = {"tree/Bark", "tree/leaf"};
    m.group.assign(m.face_count(), 0);
    m.group.back() = 1;
    return m;
}

TEST(MeshClean, SelectsWoodByGroupName) {
    const CleanMeshResult r = clean_mesh(with_groups(), {.wood = {"bark"}});
    EXPECT_EQ(r.repairs.other_material, 1u);
    EXPECT_EQ(r.repairs.cards, 0u);
    EXPECT_EQ(r.mesh.triangles.size(), 672u);
}

TEST(MeshClean, RejectsAnUnknownGroupAndListsTheExistingOnes) {
    try {
        clean_mesh(with_groups(), {.wood = {"stem"}});
        FAIL();
    } catch (const InvalidInput& e) {
        EXPECT_STREQ(e.what(), "no group is named stem; there are tree/Bark, tree/leaf");
    }
    EXPECT_THROW(clean_mesh(closed_tube(), {.wood = {"stem"}}), InvalidInput);
}

TEST(MeshClean, RejectsInvalidInput) {
    PolygonMesh m = closed_tube();
    m.add_face(std::vector<std::uint32_t>{0, 1, 9999});
    EXPECT_THROW(clean_mesh(m), InvalidInput);
    m = closed_tube();
    m.positions[7].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(clean_mesh(m), InvalidInput);
    PolygonMesh point;
    point.positions.assign(3, Vec3(1, 2, 3));
    point.add_face(std::vector<std::uint32_t>{0, 1, 2});
    EXPECT_THROW(clean_mesh(point), InvalidInput);
    EXPECT_THROW(clean_mesh(PolygonMesh{}), InvalidInput);
}

}  // namespace
}  // namespace coppice
