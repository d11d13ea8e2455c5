#include "coppice/base/radix_heap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <queue>
#include <random>
#include <utility>
#include <vector>

namespace coppice {
namespace {

using Reference = std::priority_queue<std::pair<double, std::uint32_t>,
                                      std::vector<std::pair<double, std::uint32_t>>, std::greater<>>;

/// Removes entries from both queues, and inserts `more` for each, with costs higher by step(), until `count`
/// were inserted. Expects the same order.
template <class Step>
void expect_same_order(std::uint32_t seed, std::uint32_t start, std::uint32_t more, std::uint32_t count,
                       const Step& step) {
    std::mt19937 random(seed);
    RadixHeap heap;
    Reference reference;
    std::uint32_t pushed = 0;
    const auto push = [&](double cost) {
        const std::uint32_t value = random() % 1000;
        heap.push(cost, value);
        reference.emplace(cost, value);
        ++pushed;
    };
    while (pushed < start) push(step(random));
    while (!reference.empty()) {
        ASSERT_FALSE(heap.empty());
        const auto [cost, value] = heap.pop();
        ASSERT_EQ(std::pair(cost, value), reference.top());
        reference.pop();
        for (std::uint32_t k = 0; k < more && pushed < count; ++k) push(cost + step(random));
    }
    EXPECT_TRUE(heap.empty());
}

TEST(RadixHeap, PopsInOrderOfCostThenValue) {
    const auto uniform = [](auto& random) { return std::uniform_real_distribution<double>(0, 3)(random); };
    const auto skewed = [](auto& random) { return std::exp(std::normal_distribution<double>(0, 8)(random)); };
    const auto ties = [](auto& random) { return 0.25 * (random() % 4); };
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
        for (const std::uint32_t start : {1u, 40u, 5000u}) {
            SCOPED_TRACE(start);
            expect_same_order(seed, start, 2, 20'000, uniform);
            expect_same_order(seed, start, 2, 20'000, skewed);
            expect_same_order(seed, start, 2, 20'000, ties);
        }
    }
}

TEST(RadixHeap, AcceptsManyEntriesOfOneCost) {
    // More entries than the front may contain where costs differ; and costs just above and below others.
    RadixHeap heap;
    for (std::uint32_t i = 0; i < 2000; ++i) heap.push(1, 1999 - i);
    for (std::uint32_t i = 0; i < 2000; ++i) heap.push(1.5, i);
    for (std::uint32_t i = 0; i < 2000; ++i) EXPECT_EQ(heap.pop().value, i);
    heap.push(1, 7);
    heap.push(1.25, 8);
    EXPECT_EQ(heap.pop().value, 7u);
    EXPECT_EQ(heap.pop().value, 8u);
    for (std::uint32_t i = 0; i < 2000; ++i) EXPECT_EQ(heap.pop().value, i);
    EXPECT_TRUE(heap.empty());
}

}  // namespace
}  // namespace coppice
