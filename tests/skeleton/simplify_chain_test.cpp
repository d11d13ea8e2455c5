#include "coppice/skeleton/simplify_chain.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

std::vector<std::uint32_t> find_nodes(const SimplifiedChain& chain) {
    std::vector<std::uint32_t> nodes;
    for (const ChainPoint& p : chain.points) nodes.push_back(p.node);
    return nodes;
}

using Nodes = std::vector<std::uint32_t>;

TEST(SimplifyChain, PreservesEndsAndPointsBeyondTheTolerance) {
    // A straight taper of 0.1 per metre, except for node 2, which is off by 0.02 of 0.5 radii: 4 %.
    std::vector<ChainPoint> points;
    for (std::uint32_t i = 0; i <= 4; ++i) points.push_back({{0, 0, 1.0 * i}, 0.7 - 0.1 * i, i});
    EXPECT_EQ(find_nodes(simplify_chain(points, {0.01, 0})), (Nodes{0, 4}));
    points[2].position.x = 0.02;
    EXPECT_EQ(find_nodes(simplify_chain(points, {0.03, 0})), (Nodes{0, 2, 4}));
    EXPECT_EQ(find_nodes(simplify_chain(points, {0.05, 0})), (Nodes{0, 4}));
}

TEST(SimplifyChain, LateralHasTheRadiusOfItsEnd) {
    const std::vector<ChainPoint> points{{{0, 0, 0}, 0.1, 0}, {{0, 0, 1}, 0.1, 1}, {{0, 0, 2}, 0.2, 2}};
    EXPECT_EQ(find_nodes(simplify_chain(points, {0.02, 0})), (Nodes{0, 1, 2}));
    // Between balls of 0.2 and 0.2, the one of 0.1 is off by its own radius.
    EXPECT_EQ(find_nodes(simplify_chain(points, {1.01, 0, false})), (Nodes{0, 2}));
    EXPECT_EQ(find_nodes(simplify_chain(points, {0.99, 0, false})), (Nodes{0, 1, 2}));
    // Nodes within the ball of the fork are invisible.
    EXPECT_EQ(find_nodes(simplify_chain(points, {0.02, 0, false, 1.5})), (Nodes{0, 2}));
}

// An elbow near the fork is removed, but not a bend there: the long segment after it stays in place.
TEST(SimplifyChain, MovesPointsAlongTheirSegmentAtTurns) {
    const std::vector<ChainPoint> points{{{0, 0, 0}, 0.1, 0}, {{0.08, 0, 0}, 0.1, 1}, {{0.08, 0, 4}, 0.1, 2}};
    for (const ChainRule& rule :
         {ChainRule{0.02, 0.9, false, 0.1, 0.1}, ChainRule{0.02, 0.9, true, 0, 0.1}}) {
        const SimplifiedChain chain = simplify_chain(points, rule);
        EXPECT_EQ(find_nodes(chain), (Nodes{0, 1, 2}));
        EXPECT_EQ(chain.moved, 1u);
        const Vec3d at = chain.points[1].position;
        EXPECT_NEAR(at.x, 0.08, 1e-12);
        EXPECT_NEAR(length(at), rule.fork_ball > 0 ? 0.1 : 0.09, 1e-12);
    }
    // If there is no room for it on a short segment, it is removed.
    const std::vector<ChainPoint> crowded{
        {{0, 0, 0}, 0.1, 0}, {{0.08, 0, 0}, 0.1, 1}, {{0.08, 0, 0.09}, 0.1, 2}, {{0.08, 0, 4}, 0.1, 3}};
    EXPECT_EQ(simplify_chain(crowded, {0.02, 0.9, false, 0.3, 0.1}).points.size(), 3u);
}

TEST(SimplifyChain, SeparatesJumpsAndPreservesBothRadii) {
    // Half a metre thick up to 1, a quarter from 1.05 on: too close, but both are kept.
    const std::vector<ChainPoint> points{
        {{0, 0, 0}, 0.5, 0}, {{0, 0, 1}, 0.5, 1}, {{0, 0, 1.05}, 0.25, 2}, {{0, 0, 3}, 0.25, 3}};
    const SimplifiedChain chain = simplify_chain(points, {0.02, 0.9});
    EXPECT_EQ(find_nodes(chain), (Nodes{0, 1, 2, 3}));
    EXPECT_EQ(chain.moved, 2u);
    // 0.9 radii of 0.25 are 0.225, divided equally: 0.0875 each.
    EXPECT_NEAR(chain.points[1].position.z, 0.9125, 1e-12);
    EXPECT_NEAR(chain.points[2].position.z, 1.1375, 1e-12);
}

}  // namespace
}  // namespace coppice
