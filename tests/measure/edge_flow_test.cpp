#include "coppice/measure/edge_flow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "measure/support.h"
#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

EdgeFlowReport flow(const PolygonMesh& mesh, const Skeleton& s, unsigned threads = 1) {
    const Context ctx{.threads = threads};
    const CapsuleTree capsules(s, mesh.origin, ctx);
    return edge_flow(mesh, HalfEdges(mesh, ctx), s, capsules, vertex_places(mesh, s, capsules, ctx), ctx);
}

/// Ten metres along z, of radius 0.5, in the given number of segments.
Skeleton pole(std::uint32_t segments = 1) {
    std::vector<NodeId> parents;
    std::vector<Vec3> positions;
    for (std::uint32_t i = 0; i <= segments; ++i) {
        parents.push_back(i == 0 ? kRoot : NodeId(i - 1));
        positions.push_back({0, 0, 10.0f * static_cast<float>(i) / static_cast<float>(segments)});
    }
    return Skeleton(parents, positions, std::vector<float>(segments + 1, 0.5f));
}

/// A tube along z with rows of faces that rise by `pitch` rows per turn.
PolygonMesh spiral_tube(std::uint32_t sides, std::uint32_t rows, std::uint32_t pitch) {
    PolygonMesh m;
    for (std::uint32_t j = 0; j <= rows + pitch; ++j) {
        for (std::uint32_t i = 0; i < sides; ++i) {
            const float a = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(sides);
            const float row =
                static_cast<float>(j) +
                static_cast<float>(pitch) * (static_cast<float>(i) / static_cast<float>(sides) - 1);
            m.positions.push_back(
                {0.5f * std::cos(a), 0.5f * std::sin(a), 10 * row / static_cast<float>(rows)});
        }
    }
    const auto at = [&](std::uint32_t i, std::uint32_t j) { return j * sides + i; };
    for (std::uint32_t j = 0; j < rows; ++j) {
        for (std::uint32_t i = 0; i < sides; ++i) {
            const bool last = i + 1 == sides;
            const std::uint32_t k = last ? 0 : i + 1, up = last ? pitch : 0;
            m.add_face(std::vector<std::uint32_t>{at(i, j), at(k, j + up), at(k, j + up + 1), at(i, j + 1)});
        }
    }
    return m;
}

TEST(EdgeFlow, RowsOfATubeAreRings) {
    for (const std::uint32_t segments : {1u, 7u}) {
        const EdgeFlowReport r = flow(tube(16, 40, 0.5f, 10), pole(segments));
        EXPECT_GT(r.vertices, 16u * 25);
        EXPECT_EQ(r.on_rings, r.vertices);
        EXPECT_EQ(r.on_rings_percent(), 100);
    }
}

TEST(EdgeFlow, RowsOfASpiralAreNotRings) {
    const EdgeFlowReport r = flow(spiral_tube(16, 40, 1), pole());
    EXPECT_GT(r.vertices, 16u * 25);
    EXPECT_EQ(r.on_rings, 0u);
    EXPECT_EQ(flow(spiral_tube(16, 40, 0), pole()).on_rings_percent(), 100);
}

TEST(EdgeFlow, LoopsOutsideTheAxisAreNotRings) {
    Skeleton adjacent({kRoot, NodeId(0)}, {{0.7f, 0, 0}, {0.7f, 0, 10}}, {0.5f, 0.5f});
    const EdgeFlowReport r = flow(tube(16, 40, 0.5f, 10), adjacent);
    EXPECT_GT(r.vertices, 0u);
    EXPECT_EQ(r.on_rings, 0u);
}

TEST(EdgeFlow, TrianglesInterruptLoops) {
    PolygonMesh mesh = tube(16, 40, 0.5f, 10);
    const PolygonMesh cut = to_polygons(triangulate(mesh));
    EXPECT_EQ(flow(cut, pole()).on_rings, 0u);
}

TEST(EdgeFlow, DensityIsClassifiedByRadius) {
    // Ten metres of radius 0.5, then ten of 0.1.
    const Skeleton s({kRoot, NodeId(0), NodeId(1), NodeId(2)},
                     {{0, 0, 0}, {0, 0, 10}, {0, 0, 10.001f}, {0, 0, 20}}, {0.5f, 0.5f, 0.1f, 0.1f});
    const EdgeFlowReport r = flow(tube(16, 40, 0.5f, 10), s);
    ASSERT_GE(r.classes.size(), 2u);
    EXPECT_DOUBLE_EQ(r.classes[0].radius, 0.5);
    EXPECT_NEAR(r.classes[0].length, 20, 0.01);
    EXPECT_NEAR(r.classes.back().length, 100, 0.2);
    EXPECT_GT(r.classes[0].percent, 99);
    EXPECT_NEAR(r.classes[0].per_radius(), 16.0 * 41 / 20, 1);
    EXPECT_LT(r.classes.back().per_radius(), 0.2);
}

TEST(EdgeFlow, IsBitIdenticalForAnyNumberOfThreads) {
    const PolygonMesh mesh = tube(32, 400, 0.5f, 10);
    EXPECT_EQ(flow(mesh, pole(), 1), flow(mesh, pole(), 4));
    EXPECT_EQ(flow(PolygonMesh{}, pole()).vertices, 0u);
}

}  // namespace
}  // namespace coppice
