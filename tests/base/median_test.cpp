#include "coppice/base/median.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace coppice {
namespace {

TEST(Median, IsTheUpperOfTheTwoMiddleValues) {
    EXPECT_EQ(median(std::vector{7}), 7);
    EXPECT_EQ(median(std::vector{5, 1, 3}), 3);
    EXPECT_EQ(median(std::vector{4.0, 1.0, 3.0, 2.0}), 3.0);
}

TEST(Median, PreservesTheValuesOrReordersThemInPlace) {
    const std::array<float, 5> values{9, 2, 7, 1, 5};
    EXPECT_EQ(median(values), 5);
    std::array<float, 5> own = values;
    EXPECT_EQ(median_in_place(own), 5);
    EXPECT_EQ(own[2], 5);
}

}  // namespace
}  // namespace coppice
