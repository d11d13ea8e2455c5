#include "coppice/measure/capsule_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/base/random.h"
#include "measure/support.h"

namespace coppice {
namespace {

/// A fork of two radii: trunk up z to 4, leader to 8 with a taper, lateral along x.
Skeleton fork(Vec3d origin = {}) {
    return Skeleton({kRoot, NodeId(0), NodeId(1), NodeId(1)}, {{0, 0, 0}, {0, 0, 4}, {0, 0, 8}, {5, 0, 4}},
                    {1, 1, 0.5f, 0.25f}, origin);
}

TEST(CapsuleTree, ComputesRho) {
    const CapsuleTree tree(fork(), {});
    ASSERT_EQ(tree.size(), 3u);
    const auto adjacent = tree.nearest({0, 3, 2});
    EXPECT_EQ(tree.node(adjacent.capsule), NodeId(1));
    EXPECT_DOUBLE_EQ(adjacent.rho, 3);
    const auto taper = tree.nearest({0, 1.5, 6});  // the radius is 0.75 half way up the leader
    EXPECT_EQ(tree.node(taper.capsule), NodeId(2));
    EXPECT_DOUBLE_EQ(taper.rho, 2);
    const auto lateral = tree.nearest({4, 0, 4.5});  // the lateral keeps its own radius
    EXPECT_EQ(tree.node(lateral.capsule), NodeId(3));
    EXPECT_DOUBLE_EQ(lateral.rho, 2);
    EXPECT_DOUBLE_EQ(tree.nearest({0, 0, 9}).rho, 2);  // beyond the tip
    EXPECT_DOUBLE_EQ(tree.nearest({1, 0, 4}).rho, 0);  // on the lateral's axis
}

TEST(CapsuleTree, TiesReturnTheFirstCapsule) {
    const CapsuleTree tree(fork(), {});
    EXPECT_EQ(tree.nearest({0, 2, 4}).capsule, 0u);  // trunk and leader both end there
    EXPECT_EQ(tree.nearest({0, 2, 4}, 1).capsule, 0u);
}

TEST(CapsuleTree, ConvertsOrigins) {
    const CapsuleTree tree(fork({1e6, 2e6, 100}), {1e6 - 10, 2e6, 100});
    EXPECT_DOUBLE_EQ(tree.nearest({10, 3, 2}).rho, 3);
}

TEST(CapsuleTree, NodesWithoutSegmentsAreExcluded) {
    const CapsuleTree tree(Skeleton({kRoot}, {{0, 0, 0}}, {1}), {});
    EXPECT_EQ(tree.size(), 0u);
    EXPECT_EQ(tree.nearest({1, 1, 1}).capsule, kNoIndex);
    EXPECT_FALSE(tree.any_within({0, 0, 0}, 10, 0));
}

TEST(CapsuleTree, SegmentsOfLengthZeroAreBalls) {
    const CapsuleTree tree(Skeleton({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 0}}, {1, 0.5f}), {});
    EXPECT_DOUBLE_EQ(tree.nearest({3, 0, 0}).rho, 3);
}

TEST(CapsuleTree, AxisDistanceIgnoresRadii) {
    const CapsuleTree tree(fork(), {});
    EXPECT_DOUBLE_EQ(tree.axis_distance({0, 3, 2}), 3);
    EXPECT_DOUBLE_EQ(tree.axis_distance({4, 1, 4.5}), std::hypot(1, 0.5));
    EXPECT_DOUBLE_EQ(tree.axis_distance({0, 0, 9}), 1);
    EXPECT_TRUE(std::isinf(CapsuleTree(Skeleton({kRoot}, {{0, 0, 0}}, {1}), {}).axis_distance({0, 0, 0})));
}

TEST(CapsuleTree, VisitsOnlyCapsulesWithinTheLimit) {
    const CapsuleTree tree(fork(), {});
    std::vector<std::uint32_t> seen;
    const double limit = 1;
    tree.visit_near({2, 0, 5}, limit, [&](std::uint32_t i, double d2) {
        seen.push_back(i);
        EXPECT_DOUBLE_EQ(d2, 1);
    });
    EXPECT_EQ(seen, std::vector<std::uint32_t>{2});  // the lateral; the leader is two metres away
}

TEST(CapsuleTree, MatchesExhaustiveSearch) {
    const CounterRandom random(5, 0);
    std::vector<NodeId> parent;
    std::vector<Vec3> x;
    std::vector<float> r;
    for (std::uint32_t i = 0; i < 400; ++i) {
        parent.push_back(i == 0 ? kRoot : NodeId(static_cast<std::uint32_t>(random.bits(10 * i) % i)));
        x.push_back({static_cast<float>(random.uniform(10 * i + 1)),
                     static_cast<float>(random.uniform(10 * i + 2)),
                     static_cast<float>(random.uniform(10 * i + 3))});
        r.push_back(0.001f + 0.05f * static_cast<float>(std::pow(random.uniform(10 * i + 4), 4)));
    }
    const CapsuleTree tree(Skeleton(parent, x, r), {});
    std::uint32_t hint = kNoIndex;
    for (std::uint32_t i = 0; i < 300; ++i) {
        const Vec3d p{random.uniform(9000 + 3 * i), random.uniform(9001 + 3 * i),
                      random.uniform(9002 + 3 * i)};
        double least = 1e300, others = 1e300;
        std::uint32_t best = 0;
        for (std::uint32_t c = 0; c < tree.size(); ++c) {
            const double rho2 = tree.cone(c).closest_point(p).relative_squared();
            others = std::min(others, std::max(rho2, least));
            if (rho2 >= least) continue;
            least = rho2;
            best = c;
        }
        const auto found = tree.nearest(p);
        EXPECT_EQ(found.capsule, best);
        EXPECT_EQ(found.rho, std::sqrt(least));
        EXPECT_EQ(tree.nearest(p, tree.size() - 1).capsule, best);
        EXPECT_EQ(tree.nearest(p, hint).capsule, best);
        EXPECT_TRUE(tree.any_within(p, std::sqrt(least) * 1.000001, kNoIndex));
        EXPECT_FALSE(tree.any_within(p, std::sqrt(least) * 0.999999, kNoIndex));
        EXPECT_FALSE(tree.any_within(p, std::sqrt(others) * 0.999999, best));
        EXPECT_TRUE(tree.any_within(p, std::sqrt(others) * 1.000001, best));
        hint = found.capsule;
    }
}

RoundCone axis(Vec3d a, Vec3d b) { return round_cone(a, b, 1.0, 1.0); }

TEST(Gap, IsTheDistanceBetweenSegments) {
    const RoundCone x = axis({0, 0, 0}, {4, 0, 0});
    const auto crossing = gap(x, axis({1, -2, 3}, {1, 2, 3}));
    EXPECT_DOUBLE_EQ(crossing.distance, 3);
    EXPECT_DOUBLE_EQ(crossing.s, 0.25);
    EXPECT_DOUBLE_EQ(crossing.t, 0.5);
    EXPECT_DOUBLE_EQ(gap(x, axis({1, 2, 0}, {3, 2, 0})).distance, 2);  // parallel
    EXPECT_DOUBLE_EQ(gap(x, axis({6, 0, 0}, {9, 0, 0})).distance, 2);  // in line
    EXPECT_DOUBLE_EQ(gap(x, axis({9, 0, 0}, {6, 0, 0})).distance, 2);
    EXPECT_DOUBLE_EQ(gap(x, axis({4, 3, 0}, {9, 8, 0})).distance, 3);  // end to end
    EXPECT_DOUBLE_EQ(gap(x, axis({2, 0, 5}, {2, 0, 5})).distance, 5);  // a point
    EXPECT_DOUBLE_EQ(gap(axis({2, 0, 5}, {2, 0, 5}), x).distance, 5);
}

TEST(CapsuleTree, SearchForManyPointsMatchesSingleSearches) {
    // Points near each other, points far apart, and so many axes around them that no candidate list is long
    // enough.
    for (const std::uint32_t laterals : {3u, 200u}) {
        std::vector<NodeId> parent{kRoot};
        std::vector<Vec3> position{{0, 0, 0}};
        for (std::uint32_t k = 0; k < laterals; ++k) {
            const float turn = 0.37f * static_cast<float>(k);
            parent.push_back(NodeId(0));
            position.push_back({std::cos(turn), std::sin(turn), 0.01f * static_cast<float>(k)});
        }
        const Skeleton s(parent, position, std::vector<float>(position.size(), 0.05f));
        const CapsuleTree tree(s, {});
        for (const double spacing : {0.001, 0.5}) {
            const auto point = [&](std::size_t i) {
                const auto x = static_cast<double>(i);
                return Vec3d{0.3 + spacing * x, 0.2 - 0.3 * spacing * x, 0.1};
            };
            for_each_nearest(tree, {}, 40, point, [&](std::size_t i, CapsuleTree::Nearest found) {
                const CapsuleTree::Nearest alone = tree.nearest(point(i));
                EXPECT_EQ(found.capsule, alone.capsule);
                EXPECT_EQ(found.rho, alone.rho);
            });
        }
    }
}

}  // namespace
}  // namespace coppice
