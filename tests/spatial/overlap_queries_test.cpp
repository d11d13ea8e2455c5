#include "coppice/spatial/overlap_queries.h"

#include <gtest/gtest.h>

#include <vector>

#include "coppice/base/random.h"

namespace coppice {
namespace {

/// Returns boxes along a line, with every tenth at another position; a few are large.
std::vector<Box3> boxes_along(std::uint32_t count, std::uint64_t seed, float size) {
    const CounterRandom random(seed, 0);
    std::vector<Box3> out;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto draw = [&](std::uint32_t k) { return static_cast<float>(random.uniform(4 * i + k)); };
        const float along = i % 10 == 9 ? draw(3) : static_cast<float>(i) / static_cast<float>(count);
        const Vec3 low{along, 0.1f * draw(0), 0.1f * draw(1)};
        const float edge = i % 37 == 36 ? 0.5f : size * draw(2);
        out.push_back({low, low + Vec3{edge, edge, edge}});
    }
    return out;
}

TEST(OverlapQueries, MatchSingleQueries) {
    for (const std::uint32_t count : {0u, 1u, 7u, 100u, 3000u}) {
        const std::vector<Box3> items = boxes_along(count, 1, 0.02f), wanted = boxes_along(1001, 2, 0.01f);
        const BoxTree tree(items, {});
        OverlapQueries queries(tree, items);
        std::size_t next = 5;
        queries.visit(
            {5, wanted.size()}, [&](std::size_t i) { return wanted[i]; },
            [&](std::size_t i, std::span<const std::uint32_t> found) {
                EXPECT_EQ(i, next++);
                std::vector<std::uint32_t> expected;
                tree.visit_overlapping(wanted[i], [&](std::uint32_t item) { expected.push_back(item); });
                EXPECT_TRUE(std::ranges::equal(found, expected)) << i;
            });
        EXPECT_EQ(next, wanted.size());
    }
}

}  // namespace
}  // namespace coppice
