#include "coppice/pipeline/smooth_crossings.h"

#include <gtest/gtest.h>

#include "coppice/measure/intersections.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice {
namespace {

std::size_t crossings(const QuadMesh& mesh) {
    return crossing_faces(SurfaceTree(to_polygons(mesh)), 1'000'000).pairs.size();
}

QuadMesh bar() {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}},
                     {0.2f, 0.2f, 0.2f});
    return mesh_skeleton(s).quads().mesh;
}

/// Pushes what lies within a radius of the first vertex of a quad through the other side of the bar.
QuadMesh pierced(std::uint32_t quad) {
    QuadMesh mesh = bar();
    const Vec3 at = mesh.positions[mesh.quads[quad][0]];
    for (Vec3& p : mesh.positions) {
        if (distance(p, at) < 0.1f) p += Vec3{-at.x, -at.y, 0} * 3.0f;
    }
    return mesh;
}

std::uint32_t quad_in_the_middle(const QuadMesh& mesh) {
    for (std::uint32_t q = 0; q < mesh.quads.size(); ++q) {
        if (std::abs(mesh.positions[mesh.quads[q][0]].z - 1) < 0.2f) return q;
    }
    return 0;
}

TEST(SmoothCrossings, PartsWhatWasPushedThrough) {
    const std::uint32_t quad = quad_in_the_middle(bar());
    QuadMesh mesh = pierced(quad);
    ASSERT_GT(crossings(mesh), 0u);
    const SmoothCrossingsReport report = smooth_crossings(mesh);
    EXPECT_GT(report.pairs_before, 0u);
    EXPECT_EQ(report.pairs_after, 0u);
    EXPECT_GT(report.rounds, 0u);
    EXPECT_EQ(crossings(mesh), 0u);
}

TEST(SmoothCrossings, KeepsTheBitsOfACleanMesh) {
    QuadMesh mesh = bar();
    const QuadMesh before = mesh;
    EXPECT_EQ(smooth_crossings(mesh).pairs_before, 0u);
    EXPECT_TRUE(mesh.positions == before.positions);
}

TEST(SmoothCrossings, LeavesFixedQuadsWhereTheyAre) {
    const std::uint32_t quad = quad_in_the_middle(bar());
    QuadMesh mesh = pierced(quad);
    const QuadMesh before = mesh;
    const SmoothCrossingsReport report = smooth_crossings(mesh, std::vector<std::uint32_t>{quad});
    for (const std::uint32_t v : mesh.quads[quad]) EXPECT_EQ(mesh.positions[v], before.positions[v]);
    EXPECT_EQ(crossings(mesh), report.pairs_after);
}

TEST(SmoothCrossings, SameBitsForAnyNumberOfThreads) {
    const std::uint32_t quad = quad_in_the_middle(bar());
    QuadMesh one = pierced(quad), many = one;
    smooth_crossings(one, {}, {.threads = 1});
    smooth_crossings(many, {}, {.threads = 5});
    EXPECT_TRUE(one.positions == many.positions);
}

}  // namespace
}  // namespace coppice
