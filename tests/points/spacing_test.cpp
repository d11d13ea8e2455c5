#include "coppice/points/spacing.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(MedianSpacing, IsTheDistanceToTheNearestOtherPoint) {
    PointSet line;
    for (int i = 0; i < 1000; ++i) line.positions.push_back({0.25f * static_cast<float>(i), 0, 0});
    EXPECT_EQ(median_spacing(line), 0.25);
    PointSet one;
    one.positions = {{1, 2, 3}};
    EXPECT_EQ(median_spacing(one), 0);
    one.positions = {{1, 2, 3}, {1, 2, 3}};
    EXPECT_EQ(median_spacing(one), 0);
}

TEST(WarningOfExtent, ReportsAnAxisMoreThanFiftyTimesAsLong) {
    PointSet points;
    points.positions = {{0, 0, 0}, {1, 50, 0.5f}, {0, 1, 0}};
    EXPECT_EQ(warning_of_extent(points), std::nullopt);
    points.positions = {{0, 0, 0}, {2369, 4, 3}, {7, 1, 2}};
    EXPECT_EQ(
        warning_of_extent(points),
        "the points extend 2369 m along x but 4 m at most along the other axes; is x the right column?");
    // A plate causes no warning; two points are always collinear.
    points.positions = {{0, 0, 0}, {0, 100, 100}, {0, 3, 4}};
    EXPECT_EQ(warning_of_extent(points), std::nullopt);
    points.positions = {{0, 0, 0}, {0, 0, 1}};
    EXPECT_EQ(warning_of_extent(points), std::nullopt);
    EXPECT_EQ(warning_of_extent({}), std::nullopt);
}

}  // namespace
}  // namespace coppice
