#include "coppice/edit/animate/growing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "coppice/base/error.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice {
namespace {

double compute_length(const Skeleton& s) {
    double sum = 0;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) sum += double{distance(s.position(n), s.position(s.parent(n)))};
    }
    return sum;
}

class Growing : public testing::TestWithParam<Age> {};

TEST_P(Growing, EqualsTheSkeletonAtTheEnd) {
    const Skeleton s = random_tree(200, 1);
    const Skeleton grown = GrowingTree(s, {.age = GetParam()}).at(1);
    EXPECT_TRUE(std::ranges::equal(grown.positions(), s.positions()));
    EXPECT_TRUE(std::ranges::equal(grown.radii(), s.radii()));
}

TEST_P(Growing, LengthAndRadiiNeverDecrease) {
    const Skeleton s = random_tree(200, 2);
    const GrowingTree tree(s, {.age = GetParam()});
    std::map<std::uint32_t, float> before;
    double length = 0;
    for (int i = 0; i <= 20; ++i) {
        const Skeleton now = tree.at(i / 20.0);
        std::map<std::uint32_t, float> radius;
        for (const NodeId n : nodes(now)) radius[now.stable_id(n).index()] = now.radius(n);
        for (const auto& [id, r] : before) {
            ASSERT_TRUE(radius.contains(id));
            EXPECT_GE(radius[id], r * 0.9999f);
        }
        EXPECT_GE(compute_length(now), length - 1e-6);
        EXPECT_EQ(now.tree_count(), s.tree_count());
        length = compute_length(now);
        before = radius;
    }
}

TEST_P(Growing, StartsWithFewThinNodes) {
    const Skeleton s = random_tree(200, 3);
    const Skeleton seed = GrowingTree(s, {.age = GetParam()}).at(0);
    EXPECT_LE(seed.size(), 2u);
    EXPECT_LT(seed.radius(NodeId(0)), 0.5f * s.radius(NodeId(0)));
}

INSTANTIATE_TEST_SUITE_P(Ages, Growing, testing::Values(Age::length, Age::order));

TEST(GrowingTree, GrowsAllBranchesAtEqualSpeedByLength) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 1}, {0, 0, 4}, {1, 0, 1}}, {0.2f, 0.2f, 0.1f, 0.1f});
    const Skeleton half = GrowingTree(s).at(0.5);
    ASSERT_EQ(half.size(), 4u);
    EXPECT_NEAR(half.position(NodeId(2)).z, 2, 1e-6);
    EXPECT_NEAR(half.position(NodeId(3)).x, 1, 1e-6);
    EXPECT_EQ(half.radius(NodeId(3)), 0.1f);
    EXPECT_LT(half.radius(NodeId(2)), 0.1f);
}

TEST(GrowingTree, RejectsOptionsOutOfRange) {
    const Skeleton s = random_tree(20, 1);
    EXPECT_THROW(GrowingTree(s, {.exponent = 0.5f}), InvalidInput);
}

}  // namespace
}  // namespace coppice
