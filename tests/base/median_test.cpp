#include "coppice/base/median.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <random>
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

TEST(Median, SelectsLikeTheStandardLibrary) {
    std::mt19937 random(1);
    for (const unsigned distinct : {1u, 2u, 7u, 1000000u}) {
        for (const std::size_t count : {9u, 64u, 1001u}) {
            std::vector<double> values(count);
            for (double& value : values) value = static_cast<double>(random() % distinct);
            std::vector<double> sorted = values;
            std::ranges::sort(sorted);
            EXPECT_EQ(median_in_place(values), sorted[count / 2]);
            const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
            EXPECT_LE(*std::max_element(values.begin(), middle), *middle);
            EXPECT_GE(*std::min_element(middle, values.end()), *middle);
            std::ranges::sort(values);
            EXPECT_EQ(values, sorted);
        }
    }
}

TEST(Median, IsFoundWherePivotsAreExtreme) {
    // The first and the last value, and therefore the first pivot, are the minimum. All values from 0 to 1999
    // occur twice, so that number 2000 in order is 1000.
    std::vector<int> values(4001);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<int>(std::min(i, 4000 - i));
    EXPECT_EQ(median_in_place(values), 1000);
}

}  // namespace
}  // namespace coppice
