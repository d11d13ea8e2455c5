#include "coppice/subdivision/cage_topology.h"

#include <gtest/gtest.h>

#include <set>

#include "coppice/base/error.h"
#include "errors.h"
#include "subdivision/cages.h"

namespace coppice {
namespace {

CageTopology topology(const Cage& cage, unsigned threads = 1) {
    Context ctx;
    ctx.threads = threads;
    return build_cage_topology(cage.quads, cage.vertex_count(), ctx);
}

std::string error_of(const std::vector<Quad>& quads, std::uint32_t vertices) {
    return test::error_of([&] { build_cage_topology(quads, vertices); });
}

TEST(CageTopology, ACubeHasTwelveEdgesAndFansOfThree) {
    const CageTopology t = topology(hub_cage(3));
    EXPECT_EQ(t.vertex_count(), 8u);
    EXPECT_EQ(t.edge_count(), 12u);
    EXPECT_EQ(t.face_count(), 6u);
    EXPECT_TRUE(t.closed());
    for (std::uint32_t v = 0; v < 8; ++v) EXPECT_EQ(t.fans[v].size(), 3u);
}

TEST(CageTopology, EverySideKnowsItsEdgeAndItsDirection) {
    for (const auto& [name, cage] : cage_zoo()) {
        SCOPED_TRACE(name);
        const CageTopology t = topology(cage);
        std::set<std::pair<std::uint32_t, std::uint32_t>> ends;
        for (std::uint32_t h = 0; h < 4 * t.face_count(); ++h) {
            const std::uint32_t from = t.corner(h);
            const std::uint32_t to = t.corner(CageTopology::next(h));
            const std::uint32_t side = t.side[h >> 2][h & 3];
            EXPECT_EQ((side & 1) != 0, from > to);
            EXPECT_EQ(t.edge_half[side >> 1][side & 1], h);
            ends.emplace(std::min(from, to), std::max(from, to));
        }
        EXPECT_EQ(ends.size(), t.edge_count());
    }
}

TEST(CageTopology, EdgesAndVerticesHaveOneOwner) {
    for (const auto& [name, cage] : cage_zoo()) {
        SCOPED_TRACE(name);
        const CageTopology t = topology(cage);
        std::uint32_t edges = 0;
        std::uint32_t vertices = 0;
        for (std::uint32_t h = 0; h < 4 * t.face_count(); ++h) {
            edges += t.owns_edge(h) ? 1u : 0u;
            vertices += t.owns_vertex(h) ? 1u : 0u;
        }
        EXPECT_EQ(edges, t.edge_count());
        EXPECT_EQ(vertices, t.vertex_count());
    }
}

TEST(CageTopology, BoundaryVerticesAreMarked) {
    const CageTopology t = topology(grid_cage(4, 3, false));  // 5 x 4 vertices, 3 x 2 of them inside
    ASSERT_FALSE(t.closed());
    EXPECT_EQ(std::count(t.on_boundary.begin(), t.on_boundary.end(), 1), 20 - 6);
}

TEST(CageTopology, AHubOfThousandsOfFaces) {
    const CageTopology t = topology(hub_cage(5000));
    EXPECT_EQ(t.edge_count(), 20000u);  // Euler: V - E + F = 10002 - E + 10000 = 2
    EXPECT_EQ(t.fans[10000].size(), 5000u);
}

TEST(CageTopology, SameForAnyNumberOfThreads) {
    const Cage cage = grid_cage(130, 90, true);
    const CageTopology one = topology(cage, 1);
    for (const unsigned threads : {2u, 7u}) {
        const CageTopology many = topology(cage, threads);
        EXPECT_EQ(one.side, many.side);
        EXPECT_EQ(one.edge_half, many.edge_half);
        EXPECT_EQ(one.fans, many.fans);
    }
}

TEST(CageTopology, RefusesWhatIsNotManifold) {
    EXPECT_NE(error_of({{0, 1, 2, 9}}, 4).find("quad 0"), std::string::npos);
    EXPECT_NE(error_of({{0, 1, 2, 3}, {0, 1, 1, 3}}, 4).find("quad 1"), std::string::npos);
    EXPECT_NE(error_of({{0, 1, 0, 3}}, 4).find("quad 0"), std::string::npos);
    // Three faces on edge 0-1.
    EXPECT_NE(error_of({{0, 1, 2, 3}, {1, 0, 4, 5}, {0, 1, 6, 7}}, 8).find("edge 0-1"), std::string::npos);
    // Two faces with the same direction along edge 0-1.
    EXPECT_NE(error_of({{0, 1, 2, 3}, {0, 1, 4, 5}}, 6).find("edge 0-1"), std::string::npos);
    EXPECT_NE(error_of({{0, 1, 2, 3}, {5, 4, 1, 0}, {4, 6, 7, 0}, {0, 4, 1, 6}}, 8).find("edge"),
              std::string::npos);
}

TEST(CageTopology, NothingAndVerticesWithoutFaces) {
    EXPECT_EQ(build_cage_topology({}, 0).edge_count(), 0u);
    const std::vector<Quad> quad = {{0, 1, 2, 3}};
    const CageTopology t = build_cage_topology(quad, 6);
    EXPECT_EQ(t.vertex_count(), 6u);
    EXPECT_EQ(t.edge_count(), 4u);
    EXPECT_EQ(t.fans.items.size(), 4u);
}

}  // namespace
}  // namespace coppice
