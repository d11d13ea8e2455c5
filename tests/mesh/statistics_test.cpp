#include "coppice/mesh/statistics.h"

#include <gtest/gtest.h>

#include <string>

namespace coppice {
namespace {

TEST(Statistics, ComputesRanksOfAPermutation) {
    std::vector<double> values;
    for (int i = 0; i < 200; ++i)
        values.push_back((i * 77) % 200 -
                         100);  // a permutation of -100 .. 99, because 77 and 200 have no common factor
    const Statistics s = statistics(values);
    EXPECT_EQ(s.n, 200u);
    EXPECT_DOUBLE_EQ(s.min, -100);
    EXPECT_DOUBLE_EQ(s.p1, -100 + 2);
    EXPECT_DOUBLE_EQ(s.p5, -100 + 10);
    EXPECT_DOUBLE_EQ(s.p50, -100 + 100);
    EXPECT_DOUBLE_EQ(s.p95, 99 - 10);
    EXPECT_DOUBLE_EQ(s.p99, 99 - 2);
    EXPECT_DOUBLE_EQ(s.max, 99);
    EXPECT_DOUBLE_EQ(s.mean, -0.5);
    EXPECT_DOUBLE_EQ(s.mean_abs, 50);  // (1 + .. + 100 + 1 + .. + 99) / 200
}

TEST(Statistics, AcceptsFewAndNoValues) {
    EXPECT_EQ(statistics({}), Statistics{});
    EXPECT_EQ(statistics({3}), (Statistics{1, 3, 3, 3, 3, 3, 3, 3, 3, 3}));
    EXPECT_EQ(statistics({4, -2}), (Statistics{2, 1, 3, -2, -2, 4, 4, 4, -2, 4}));
}

TEST(Statistics, FiguresAreVisitedInOrder) {
    std::string names;
    visit_figures(statistics({1, 2}), [&](const char* name, auto) { names += std::string(name) + ' '; });
    EXPECT_EQ(names, "n mean mean_abs p1 p5 p50 p95 p99 min max ");
    names.clear();
    visit_figures(Statistics{}, [&](const char* name, auto) { names += std::string(name) + ' '; });
    EXPECT_EQ(names, "n ");
}

}  // namespace
}  // namespace coppice
