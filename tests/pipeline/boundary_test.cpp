#include "coppice/pipeline/remesh/boundary_internal.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

// A strip of triangles around a prism, open at both ends: lower ring 0 .. n - 1, upper ring n .. 2 n - 1.
std::vector<Triangle> tube(std::uint32_t n) {
    std::vector<Triangle> out;
    for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t next = (k + 1) % n;
        out.push_back({k, next, n + next});
        out.push_back({k, n + next, n + k});
    }
    return out;
}

TEST(Boundary, OfATubeHasTwoLoopsInTheDirectionOfItsFaces) {
    const Boundary b = compute_boundary(tube(5));
    EXPECT_TRUE(b.pinched.empty());
    ASSERT_EQ(b.loops.size(), 2u);
    EXPECT_EQ(b.loops[0], (Loop{0, 1, 2, 3, 4}));
    EXPECT_EQ(b.loops[1], (Loop{5, 9, 8, 7, 6}));
}

TEST(Boundary, OfAClosedSurfaceIsEmpty) {
    const std::vector<Triangle> tetrahedron{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    const Boundary b = compute_boundary(tetrahedron);
    EXPECT_TRUE(b.loops.empty());
    EXPECT_TRUE(b.pinched.empty());
}

TEST(Boundary, ExcludesTouchingLoopsAndReportsTheVertex) {
    const std::vector<Triangle> bow{{0, 1, 2}, {2, 3, 4}, {5, 6, 7}};
    const Boundary b = compute_boundary(bow);
    EXPECT_EQ(b.pinched, (std::vector<std::uint32_t>{2}));
    ASSERT_EQ(b.loops.size(), 1u);
    EXPECT_EQ(b.loops[0], (Loop{5, 6, 7}));
}

TEST(Boundary, IsLimitedToTheGivenVertices) {
    const std::vector<Triangle> faces = tube(4);
    std::vector<std::uint8_t> rim(8, 0);
    for (std::size_t v = 0; v < 4; ++v) rim[v] = 1;
    const Boundary b = compute_boundary(faces, rim);
    ASSERT_EQ(b.loops.size(), 1u);
    EXPECT_EQ(b.loops[0], (Loop{0, 1, 2, 3}));
}

}  // namespace
}  // namespace coppice
