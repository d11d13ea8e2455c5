#include "coppice/extract/tree/simplify_internal.h"

#include <gtest/gtest.h>

#include "coppice/base/id.h"

namespace coppice::extract_internal {
namespace {

/// Returns a stem along z with nodes at these heights.
InitialTree stem(const std::vector<double>& heights, double radius) {
    InitialTree t;
    for (const double z : heights) t.add(t.size() == 0 ? kNoIndex : t.size() - 1, {0, 0, z}, radius);
    return t;
}

TEST(Simplify, RemovesRedundantNodesAndMovesTheirSamplesToTheTip) {
    InitialTree t = stem({0, 1, 2, 3, 4}, 0.1);
    t.radius[2] = 0.15;
    FitSamples samples{{}, {}, {0, 1, 2, 3, kNoIndex}};
    simplify(t, samples, 0.02);
    EXPECT_EQ(t.position, (std::vector<Vec3d>{{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}}));
    t.radius[2] = 0.1;
    simplify(t, samples, 0.02);
    EXPECT_EQ(t.position, (std::vector<Vec3d>{{0, 0, 0}, {0, 0, 4}}));
    EXPECT_EQ(t.parent, (std::vector<std::uint32_t>{kNoIndex, 0}));
    EXPECT_EQ(samples.node, (std::vector<std::uint32_t>{0, 1, 1, 1, kNoIndex}));
}

TEST(Simplify, MergesForksNearerThanHalfARadius) {
    for (const double apart : {0.05, 0.15}) {  // a quarter of a radius, and three quarters
        InitialTree t = stem({0, 1, 1 + apart, 2}, 0.2);
        t.radius[2] = 0.21;
        t.add(1, {0.6, 0, 1.3}, 0.05);
        t.add(2, {-0.6, 0, 1.35}, 0.05);
        FitSamples samples{{}, {}, {2}};
        simplify(t, samples, 0.02);
        const bool one = apart < 0.1;
        ASSERT_EQ(t.size(), one ? 5u : 6u);
        const std::uint32_t fork = samples.node[0];
        EXPECT_EQ(t.position[fork], Vec3d(0, 0, 1 + apart));  // at the position of the thicker one
        EXPECT_EQ(InitialTreeLinks(t).children(fork).size(), one ? 3u : 2u);
    }
}

TEST(Simplify, PreservesCoordinatesExactly) {
    InitialTree t = stem({0, 1.0 / 3, 1}, 1.0 / 30);
    t.position[1].x = 1.0 / 7;
    const InitialTree before = t;
    FitSamples samples;
    simplify(t, samples, 0.02);
    EXPECT_EQ(t.position, before.position);
    EXPECT_EQ(t.radius, before.radius);
}

TEST(Simplify, MergesNodesNearerThanTheirRadius) {
    // A kink of two nodes 0.05 apart, half a radius, then the same five radii apart.
    for (const double apart : {0.05, 0.5}) {
        InitialTree t;
        t.add(kNoIndex, {0, 0, 0}, 0.1);
        t.add(0, {0, 0, 1}, 0.1);
        t.add(1, {0, apart * 0.5, 1 + apart}, 0.1);
        t.add(2, {0, 1, 2}, 0.1);
        FitSamples samples;
        simplify(t, samples, 0.02);
        EXPECT_EQ(t.size(), apart < 0.09 ? 3u : 4u);
    }
}

TEST(Simplify, PreservesTheLeader) {
    // The node that makes the stem the leader is on the axis towards a thinner one, and is not required
    // otherwise.
    InitialTree t = stem({0, 1, 1.5, 2}, 0.1);
    t.radius[2] = 0.0995;
    t.radius[3] = 0.099;
    t.add(1, {1, 0, 1}, 0.0992);
    FitSamples samples;
    simplify(t, samples, 0.02);
    const InitialTreeLinks links(t);
    for (std::uint32_t n = 0; n < t.size(); ++n) {
        if (links.children(n).size() < 2) continue;
        EXPECT_EQ(t.position[links.leader(n)].x, 0);
    }
}

}  // namespace
}  // namespace coppice::extract_internal
