#include "coppice/base/kernel/morton.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(Morton, InterleavesTheBitsOfTheAxes) {
    EXPECT_EQ(morton_code(0, 0, 0), 0u);
    EXPECT_EQ(morton_code(1, 0, 0), 1u);
    EXPECT_EQ(morton_code(0, 1, 0), 2u);
    EXPECT_EQ(morton_code(0, 0, 1), 4u);
    EXPECT_EQ(morton_code(5, 3, 6), 0b101'110'011u);  // x = 101, y = 011, z = 110: highest bits z y x first
}

TEST(Morton, LastCellHasAllBits) {
    constexpr std::uint64_t kLast = kMortonCells - 1;
    EXPECT_EQ(morton_code(kLast, kLast, kLast), (std::uint64_t{1} << 63) - 1);
    EXPECT_EQ(morton_code(kLast, 0, 0), kMortonAxis);
    EXPECT_EQ(morton_code(0, 0, kLast), kMortonAxis << 2);
    // Bit b of x comes to place 3 b.
    for (unsigned b = 0; b < 21; ++b)
        EXPECT_EQ(morton_code(std::uint64_t{1} << b, 0, 0), std::uint64_t{1} << 3 * b);
}

}  // namespace
}  // namespace coppice
