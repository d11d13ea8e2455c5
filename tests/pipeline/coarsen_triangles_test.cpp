#include "coppice/pipeline/remesh/coarsen_triangles_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
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

// Corners at the vertices of the sphere themselves, so that only short edges collapse.
std::vector<GridCorner> own_corners(const TriMesh& mesh, float spacing) {
    std::vector<GridCorner> out;
    for (const Vec3 p : mesh.positions) out.push_back({p, normalized(p), spacing});
    return out;
}

void expect_sphere(const TriMesh& mesh, double tolerance) {
    const PolygonMesh faces = to_polygons(mesh);
    const TopologyReport t = topology(faces);
    EXPECT_TRUE(t.watertight());
    EXPECT_EQ(t.euler, 2);
    const ShapeReport s = shape(faces);
    EXPECT_EQ(s.inverted_faces, 0u);
    EXPECT_NEAR(s.signed_volume, 4 * std::numbers::pi / 3, tolerance);
}

TEST(CoarsenTriangles, CollapsesShortEdges) {
    for (const float spacing : {0.2f, 0.4f}) {
        TriMesh mesh = make_sphere(64);
        const std::size_t before = mesh.triangles.size();
        coarsen_triangles(mesh, own_corners(mesh, spacing));
        EXPECT_LT(mesh.triangles.size(), before / 2);
        for (const Triangle& t : mesh.triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                const float length = distance(mesh.positions[t[k]], mesh.positions[t[(k + 1) % 3]]);
                EXPECT_GT(length, 0.3f * spacing);
                EXPECT_LT(length, 2.6f * spacing);
            }
        }
        expect_sphere(mesh, 4 * spacing * spacing);
    }
}

// The corners of a cube, each with an eighth of the sphere.
TEST(CoarsenTriangles, JoinsTheVerticesOfACorner) {
    TriMesh mesh = make_sphere(32);
    std::vector<GridCorner> corners;
    const auto sign = [](float x) { return x < 0.01f ? -1.0f : 1.0f; };
    for (const Vec3 p : mesh.positions) {
        const Vec3 corner = normalized(Vec3{sign(p.x), sign(p.y), sign(p.z)});
        corners.push_back({corner, normalized(p), 1});
    }
    coarsen_triangles(mesh, corners);
    ASSERT_EQ(mesh.positions.size(), 8u);
    for (const Vec3 p : mesh.positions) {
        for (const float x : {p.x, p.y, p.z}) EXPECT_NEAR(std::abs(x), 1 / std::sqrt(3.0f), 0.3f);
    }
    expect_sphere(mesh, 3);
}

// Every second row of the sphere has edges along the longer diagonals of its cells.
TEST(CoarsenTriangles, FlipsEdgesOfPoorTriangles) {
    TriMesh mesh = make_sphere(32);
    const auto longest_edge = [&] {
        float longest = 0;
        for (const Triangle& t : mesh.triangles) {
            for (std::size_t k = 0; k < 3; ++k)
                longest = std::max(longest, distance(mesh.positions[t[k]], mesh.positions[t[(k + 1) % 3]]));
        }
        return longest;
    };
    const float before = longest_edge();
    const std::size_t count = mesh.triangles.size();
    coarsen_triangles(mesh, own_corners(mesh, 0));
    EXPECT_EQ(mesh.triangles.size(), count);
    EXPECT_LT(longest_edge(), 0.8f * before);
    expect_sphere(mesh, 0.1);
}

TEST(CoarsenTriangles, KeepsVerticesAndReturnsThem) {
    TriMesh mesh = make_sphere(32);
    const Buffer<Vec3> before(mesh.positions);
    const std::vector<std::uint32_t> kept = coarsen_triangles(mesh, own_corners(mesh, 0.3f));
    ASSERT_EQ(kept.size(), mesh.positions.size());
    EXPECT_TRUE(std::ranges::is_sorted(kept));
    for (std::size_t v = 0; v < kept.size(); ++v) EXPECT_EQ(mesh.positions[v], before[kept[v]]);
    for (const Triangle& t : mesh.triangles) {
        for (const std::uint32_t v : t) EXPECT_LT(v, kept.size());
    }
}

TEST(CoarsenTriangles, LeavesVerticesWithoutSpacingAndLongEdges) {
    for (const float spacing : {0.0f, 0.01f}) {
        TriMesh mesh = make_sphere(16);
        EXPECT_EQ(coarsen_triangles(mesh, own_corners(mesh, spacing)).size(),
                  make_sphere(16).positions.size());
    }
}

// Half of the sphere keeps its vertices.
TEST(CoarsenTriangles, FollowsTheSpacingAtEachVertex) {
    TriMesh mesh = make_sphere(32);
    std::vector<GridCorner> corners = own_corners(mesh, 0.5f);
    for (GridCorner& c : corners) c.spacing = c.position.z > 0 ? c.spacing : 0;
    const auto count_below = [&] {
        return std::ranges::count_if(mesh.positions, [](Vec3 p) { return p.z <= 0; });
    };
    const auto below = count_below();
    const std::size_t before = mesh.positions.size();
    coarsen_triangles(mesh, corners);
    EXPECT_EQ(count_below(), below);
    EXPECT_LT(mesh.positions.size(), before * 3 / 4);
}

}  // namespace
}  // namespace coppice
