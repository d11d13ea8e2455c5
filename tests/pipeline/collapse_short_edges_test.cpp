#include "coppice/pipeline/remesh/collapse_short_edges_internal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"

namespace coppice {
namespace {

// A sphere of radius 1: each row of `around` points is turned by half a column.
TriMesh make_sphere(std::uint32_t around) {
    TriMesh out;
    const std::uint32_t rows = around / 2 - 1;
    out.positions.push_back({0, 0, -1});
    for (std::uint32_t row = 0; row < rows; ++row) {
        const float latitude =
            std::numbers::pi_v<float> * (static_cast<float>(row + 1) / static_cast<float>(rows + 1) - 0.5f);
        for (std::uint32_t k = 0; k < around; ++k) {
            const float angle = 2 * std::numbers::pi_v<float> *
                                (static_cast<float>(k) + 0.5f * static_cast<float>(row % 2)) /
                                static_cast<float>(around);
            out.positions.push_back({std::cos(latitude) * std::cos(angle),
                                     std::cos(latitude) * std::sin(angle), std::sin(latitude)});
        }
    }
    out.positions.push_back({0, 0, 1});
    const auto at = [&](std::uint32_t row, std::uint32_t k) { return 1 + row * around + k % around; };
    for (std::uint32_t k = 0; k < around; ++k) {
        out.triangles.push_back({0, at(0, k + 1), at(0, k)});
        out.triangles.push_back(
            {at(rows - 1, k), at(rows - 1, k + 1), static_cast<std::uint32_t>(out.positions.size() - 1)});
        for (std::uint32_t row = 0; row + 1 < rows; ++row) {
            out.triangles.push_back({at(row, k), at(row, k + 1), at(row + 1, k)});
            out.triangles.push_back({at(row, k + 1), at(row + 1, k + 1), at(row + 1, k)});
        }
    }
    return out;
}

float mean_edge(const TriMesh& mesh) {
    float sum = 0;
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k)
            sum += distance(mesh.positions[t[k]], mesh.positions[t[(k + 1) % 3]]);
    }
    return sum / static_cast<float>(3 * mesh.triangles.size());
}

TEST(CollapseShortEdges, MakesEdgesOfTheRequestedLength) {
    for (const float edge : {0.2f, 0.4f}) {
        TriMesh mesh = make_sphere(64);
        const std::size_t before = mesh.triangles.size();
        collapse_short_edges(mesh, std::vector<float>(mesh.positions.size(), edge));
        EXPECT_LT(mesh.triangles.size(), before / 2);
        EXPECT_NEAR(mean_edge(mesh), edge, 0.15f * edge);
        const PolygonMesh faces = to_polygons(mesh);
        const TopologyReport t = topology(faces);
        EXPECT_TRUE(t.watertight());
        EXPECT_EQ(t.euler, 2);
        const ShapeReport s = shape(faces);
        EXPECT_EQ(s.inverted_faces, 0u);
        EXPECT_NEAR(s.signed_volume, 4 * std::numbers::pi / 3, 2 * edge * edge);
    }
}

TEST(CollapseShortEdges, KeepsVerticesAndReturnsThem) {
    TriMesh mesh = make_sphere(32);
    const Buffer<Vec3> before(mesh.positions);
    const std::vector<std::uint32_t> kept =
        collapse_short_edges(mesh, std::vector<float>(mesh.positions.size(), 0.3f));
    ASSERT_EQ(kept.size(), mesh.positions.size());
    EXPECT_TRUE(std::ranges::is_sorted(kept));
    for (std::size_t v = 0; v < kept.size(); ++v) EXPECT_EQ(mesh.positions[v], before[kept[v]]);
    for (const Triangle& t : mesh.triangles) {
        for (const std::uint32_t v : t) EXPECT_LT(v, kept.size());
    }
}

TEST(CollapseShortEdges, LeavesEdgesWithoutALengthAndLongOnes) {
    for (const float edge : {0.0f, 0.01f}) {
        TriMesh mesh = make_sphere(16);
        const std::size_t before = mesh.triangles.size();
        EXPECT_EQ(collapse_short_edges(mesh, std::vector<float>(mesh.positions.size(), edge)).size(),
                  mesh.positions.size());
        EXPECT_EQ(mesh.triangles.size(), before);
    }
}

// Half of the sphere keeps its triangles.
TEST(CollapseShortEdges, FollowsTheLengthAtEachVertex) {
    TriMesh mesh = make_sphere(32);
    std::vector<float> edge;
    for (const Vec3 p : mesh.positions) edge.push_back(p.z > 0 ? 0.5f : 0.0f);
    const auto count_below = [&] {
        return std::ranges::count_if(mesh.positions, [](Vec3 p) { return p.z <= 0; });
    };
    const auto below = count_below();
    const std::size_t before = mesh.positions.size();
    collapse_short_edges(mesh, edge);
    EXPECT_EQ(count_below(), below);
    EXPECT_LT(mesh.positions.size(), before * 3 / 4);
}

}  // namespace
}  // namespace coppice
