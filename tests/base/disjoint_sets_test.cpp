#include "coppice/base/disjoint_sets.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace coppice {
namespace {

TEST(DisjointSets, RepresentativeIsTheSmallestMember) {
    DisjointSets sets(6);
    EXPECT_TRUE(sets.join(5, 3));
    EXPECT_TRUE(sets.join(4, 1));
    EXPECT_TRUE(sets.join(3, 4));
    EXPECT_FALSE(sets.join(5, 1));
    for (const std::uint32_t i : {1u, 3u, 4u, 5u}) EXPECT_EQ(sets.find(i), 1u);
    EXPECT_EQ(sets.find(0), 0u);
    EXPECT_EQ(sets.find(2), 2u);
    sets.reset(4);
    for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(sets.find(i), i);
}

TEST(DisjointSets, ContainsTheJoinsOfSeveralThreads) {
    // Numbers of equal remainder belong together: 1000 sets of 100. Every thread joins each fourth pair, two
    // of them in reverse order.
    constexpr std::uint32_t kCount = 100'000, kSets = 1000, kThreads = 4;
    constexpr std::uint32_t kEach = (kCount - kSets) / kThreads;
    ConcurrentDisjointSets sets(kCount);
    std::vector<std::jthread> threads;
    for (std::uint32_t t = 0; t < kThreads; ++t) {
        threads.emplace_back([&, t] {
            for (std::uint32_t k = 0; k < kEach; ++k) {
                const std::uint32_t i = kThreads * (t % 2 == 0 ? k : kEach - 1 - k) + t;
                sets.join(i, i + kSets);
            }
        });
    }
    threads.clear();
    EXPECT_EQ(sets.set_count(), kSets);
}

}  // namespace
}  // namespace coppice
