#include "coppice/base/kernel/partition_point.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace coppice {
namespace {

TEST(PartitionPointTest, MatchesTheStandardLibrary) {
    constexpr std::array<std::uint32_t, 9> kAscending{0, 2, 2, 2, 5, 7, 8, 8, 11};
    for (std::size_t size = 0; size <= kAscending.size(); ++size) {
        const std::span<const std::uint32_t> items(kAscending.data(), size);
        for (std::uint32_t number = 0; number < 13; ++number) {
            const auto lower = std::ranges::lower_bound(items, number) - items.begin();
            const auto upper = std::ranges::upper_bound(items, number) - items.begin();
            EXPECT_EQ(kernel::partition_point(items, [&](std::uint32_t n) { return n < number; }), lower);
            EXPECT_EQ(kernel::partition_point(items, [&](std::uint32_t n) { return n <= number; }), upper);
        }
    }
}

}  // namespace
}  // namespace coppice
