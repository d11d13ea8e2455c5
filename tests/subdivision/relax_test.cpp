#include "coppice/subdivision/relax_internal.h"

#include <gtest/gtest.h>

#include <cstring>

#include "subdivision/cages.h"

namespace coppice {
namespace {

TEST(TangentialRelaxation, EqualizesAGridInItsPlane) {
    Cage cage = grid_cage(2, 2, false);
    cage.points[4] = {1.4f, 0.8f, 0};  // the only inner vertex; its neighbours' mean is (1, 1, 0)
    const TangentialRelaxation relaxation(cage.quads, 9);
    const Buffer<Vec3> out = relaxation.step(cage.points, 0.5f);
    EXPECT_NEAR(out[4].x, 1.2f, 1e-6f);
    EXPECT_NEAR(out[4].y, 0.9f, 1e-6f);
    EXPECT_EQ(out[4].z, 0);
    for (const std::size_t v : {0u, 1u, 2u, 3u, 5u, 6u, 7u, 8u}) EXPECT_EQ(out[v], cage.points[v]);
}

TEST(TangentialRelaxation, DoesNotMoveAlongTheNormal) {
    Cage cage = grid_cage(2, 2, false);
    cage.points[4].z = 1;  // a symmetric bump: the displacement is along the normal only
    const Buffer<Vec3> out = TangentialRelaxation(cage.quads, 9).step(cage.points, 1);
    EXPECT_NEAR(distance(out[4], cage.points[4]), 0, 1e-6f);
}

TEST(TangentialRelaxation, AcceptsDegenerateAndUnusedVertices) {
    const std::vector<Quad> quads = {{0, 1, 2, 3}, {3, 2, 1, 0}};
    const std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 2, 3}};
    const Buffer<Vec3> out = TangentialRelaxation(quads, 5).step(points, 0.3f);
    for (std::size_t v = 0; v < 5; ++v) EXPECT_EQ(out[v], points[v]);
}

TEST(TangentialRelaxation, IsBitIdenticalForAnyNumberOfThreads) {
    const Cage cage = shaken(grid_cage(200, 100, true), 0.02f);
    const TangentialRelaxation relaxation(cage.quads, cage.vertex_count());
    const Buffer<Vec3> one = relaxation.step(cage.points, 0.3f, {.threads = 1, .stop = {}, .progress = {}});
    for (const unsigned threads : {2u, 7u}) {
        const Buffer<Vec3> many =
            relaxation.step(cage.points, 0.3f, {.threads = threads, .stop = {}, .progress = {}});
        EXPECT_EQ(std::memcmp(one.data(), many.data(), one.size() * sizeof(Vec3)), 0);
    }
}

}  // namespace
}  // namespace coppice
