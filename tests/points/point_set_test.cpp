#include "coppice/points/point_set.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(PointSet, MergedPreservesPositionsOrderAndTheFirstOrigin) {
    PointSet a, b;
    a.positions = {{1, 0, 0}};
    a.origin = {100, 0, 0};
    b.positions = {{2, 0, 0}, {3, 0, 0}};
    b.origin = {90, 0, 0};
    const PointSet both = merged(a, b);
    ASSERT_EQ(both.size(), 3u);
    EXPECT_EQ(both.origin, a.origin);
    EXPECT_EQ(both.world(0), Vec3d(101, 0, 0));
    EXPECT_EQ(both.world(1), Vec3d(92, 0, 0));
    EXPECT_EQ(both.world(2), Vec3d(93, 0, 0));
    EXPECT_EQ(merged(PointSet{}, b), b);
    EXPECT_EQ(merged(b, PointSet{}), b);
}

TEST(PointSet, BoundsContainAllPoints) {
    PointSet set;
    EXPECT_TRUE(bounds(set).empty());
    set.positions = {{1, 2, 3}, {-1, 5, 3}};
    EXPECT_EQ(bounds(set).low, Vec3(-1, 2, 3));
    EXPECT_EQ(bounds(set).high, Vec3(1, 5, 3));
}

}  // namespace
}  // namespace coppice
