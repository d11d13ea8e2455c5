#include <gtest/gtest.h>

#include <vector>

#include "coppice/measure/intersections.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/pipeline/fit/limit_offsets_internal.h"
#include "mesh/shapes.h"

namespace coppice::pipeline_internal {
namespace {

using namespace shapes;

/// Moves all vertices of a mesh along x by `way`, as far as possible.
struct Moved {
    PolygonMesh start;
    CompressedRows<std::uint32_t> faces_of;
    std::vector<Vec3> direction;
    std::vector<float> offsets;
    LimitResult result;

    template <class Way>
    Moved(PolygonMesh mesh, const Way& way, std::uint32_t halvings)
        : start(std::move(mesh)),
          faces_of(faces_by_vertex(start)),
          direction(start.positions.size(), {1, 0, 0}) {
        for (const Vec3 p : start.positions) offsets.push_back(way(p));
        result = limit_offsets({start, faces_of, direction}, offsets, halvings, {});
    }
};

TEST(LimitOffsets, PreservesHarmlessOffsets) {
    const Moved m(
        both(cube(), box({3, -1, -1}, {5, 1, 1})), [](Vec3 p) { return p.x < 2 ? 0.5f : -0.5f; }, 4);
    EXPECT_EQ(m.result.rounds, 0u);
    for (const float o : m.offsets) EXPECT_EQ(std::fabs(o), 0.5f);
}

TEST(LimitOffsets, ReducesOffsetsThatCauseIntersections) {
    // Boxes that are 0.1 apart and move 0.08 towards each other: half of that is less than half the gap.
    const PolygonMesh two = both(box({-1, -1, -1}, {1, 1, 1}), box({1.1f, -0.9f, -0.9f}, {3, 0.9f, 0.9f}));
    const auto together = [](Vec3 p) { return p.x < 1.05f ? 0.08f : -0.08f; };
    const Moved halved(two, together, 4);
    EXPECT_EQ(halved.result.rounds, 1u);
    EXPECT_TRUE(halved.result.complete);
    const Moved wholly(two, together, 0);
    PolygonMesh after = two;
    apply_offsets({wholly.start, wholly.faces_of, wholly.direction}, wholly.offsets, after.positions, {});
    EXPECT_TRUE(crossing_faces(SurfaceTree(after), 100).pairs.empty());
    for (std::size_t v = 0; v < two.positions.size(); ++v) {
        if (two.positions[v].x == 1) {
            EXPECT_EQ(wholly.offsets[v], 0);
        }
    }
}

TEST(LimitOffsets, ReducesOffsetsThatCauseFolds) {
    // The near side of a box passes through the far one: faces between them are inverted.
    const Moved m(
        box({0, 0, 0}, {1, 1, 1}), [](Vec3 p) { return p.x < 0.5f ? 1.5f : 0.0f; }, 4);
    EXPECT_GT(m.result.rounds, 0u);
    for (std::size_t v = 0; v < m.offsets.size(); ++v) {
        if (m.start.positions[v].x < 0.5f) {
            EXPECT_LT(m.offsets[v], 1);
        }
    }
}

TEST(LimitOffsets, IgnoresExistingIntersections) {
    const PolygonMesh two = both(cube(), box({0.5f, 0.5f, 0.5f}, {1.5f, 1.5f, 1.5f}));
    const Moved m(
        two, [](Vec3) { return 0.25f; }, 4);
    EXPECT_EQ(m.result.rounds, 0u);
    for (const float o : m.offsets) EXPECT_EQ(o, 0.25f);
}

TEST(AreaVector, IsTheNormalTimesTheArea) {
    const std::vector<Vec3> x{{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}};
    const std::vector<std::uint32_t> quad{0, 1, 2, 3}, triangle{0, 1, 2};
    EXPECT_EQ(area_vector(quad, x), Vec3d(0, 0, 6));
    EXPECT_EQ(area_vector(triangle, x), Vec3d(0, 0, 3));
}

}  // namespace
}  // namespace coppice::pipeline_internal
