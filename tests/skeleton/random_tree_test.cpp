#include "coppice/skeleton/random_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/base/hash.h"

namespace coppice {
namespace {

std::uint64_t compute_hash(const Skeleton& s) {
    return Hash().add(s.parents()).add(s.positions()).add(s.radii()).value();
}

TEST(RandomTree, HasTheRequestedNumberOfSegments) {
    for (const std::uint32_t segments : {1u, 2u, 7u, 8u, 9u, 50u, 333u, 3000u}) {
        for (const bool hard : {false, true}) {
            const Skeleton s = random_tree(segments, 5, hard);
            EXPECT_EQ(s.size(), segments + 1);
            EXPECT_EQ(s.tree_count(), 1u);
        }
    }
}

TEST(RandomTree, DependsOnItsArgumentsOnly) {
    EXPECT_EQ(compute_hash(random_tree(500, 1)), compute_hash(random_tree(500, 1)));
    EXPECT_NE(compute_hash(random_tree(500, 1)), compute_hash(random_tree(500, 2)));
    EXPECT_NE(compute_hash(random_tree(500, 1)), compute_hash(random_tree(500, 1, true)));
}

TEST(RandomTree, FollowsThePipeModel) {
    const Skeleton s = random_tree(2000, 3);
    const double leaf = 0.08 * std::pow(0.01, 2.2);
    for (const NodeId n : nodes(s)) {
        if (s.is_tip(n)) {
            EXPECT_FLOAT_EQ(s.radius(n), 0.01f);
            continue;
        }
        double sum = s.is_root(n) ? 0 : leaf;
        for (const NodeId c : s.children(n)) sum += std::pow(static_cast<double>(s.radius(c)), 2.2);
        EXPECT_NEAR(std::pow(sum, 1 / 2.2), s.radius(n), 1e-5 * s.radius(n));
    }
}

TEST(RandomTree, HardTreesHaveShortSegmentsAndWhorls) {
    const auto shortest = [](const Skeleton& s) {
        float least = 1e9f;
        for (const NodeId n : nodes(s)) {
            if (s.is_root(n)) continue;
            const Segment g = s.segment(n);
            least = std::min(least, distance(g.a, g.b) / s.radius(s.parent(n)));
        }
        return least;
    };
    const auto max_children = [](const Skeleton& s) {
        std::size_t most = 0;
        for (const NodeId n : nodes(s)) most = std::max(most, s.children(n).size());
        return most;
    };
    EXPECT_GT(shortest(random_tree(1000, 4)), 1);
    EXPECT_LT(shortest(random_tree(1000, 4, true)), 0.7f);
    EXPECT_LE(max_children(random_tree(1000, 4)), 3u);
    EXPECT_GE(max_children(random_tree(1000, 4, true)), 6u);
}

/// Returns the number of pairs of segments that are not adjacent and closer than the sum of their radii, by
/// brute force over their midpoints.
int collisions(const Skeleton& s) {
    int count = 0;
    for (const NodeId i : nodes(s)) {
        for (const NodeId j : nodes(s)) {
            if (!(j < i) || s.is_root(i) || s.is_root(j)) continue;
            const NodeId pi = s.parent(i), pj = s.parent(j);
            if (pi == pj || pi == j || pj == i || pj == s.parent(pi)) continue;
            const Segment a = s.segment(i), b = s.segment(j);
            if (distance(lerp(a.a, a.b, 0.5f), lerp(b.a, b.b, 0.5f)) < s.radius(i) + s.radius(j)) ++count;
        }
    }
    return count;
}

TEST(RandomTree, BranchesDoNotCollideUnlessHard) {
    EXPECT_LE(collisions(random_tree(1000, 6)), 2);
    EXPECT_GT(collisions(random_tree(1000, 6, true)), 10);
}

TEST(RandomTree, RejectsZeroSegments) { EXPECT_THROW(random_tree(0, 1), InvalidInput); }

}  // namespace
}  // namespace coppice
