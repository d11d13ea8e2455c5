#include "coppice/base/box.h"

#include <gtest/gtest.h>

#include <cmath>

namespace coppice {
namespace {

// Corners (1, 5, -2) and (-1, 2, 3): from (-1, 2, -2) to (1, 5, 3).
Box3 two_corners() {
    Box3 box;
    box.extend(Vec3{1, 5, -2});
    box.extend(Vec3{-1, 2, 3});
    return box;
}

TEST(Box3, TheDefaultIsEmpty) {
    const Box3 none;
    EXPECT_TRUE(none.empty());
    EXPECT_EQ(none.size(), (Vec3{0, 0, 0}));
    EXPECT_EQ(none.diagonal(), 0);
    EXPECT_FALSE(none.overlaps(none));
    EXPECT_FALSE(none.overlaps(two_corners()));
    EXPECT_FALSE(two_corners().overlaps(none));
    EXPECT_TRUE(none.inflated(1).empty());
}

TEST(Box3, OnePointHasSizeZero) {
    Box3 box;
    box.extend(Vec3{1, -2, 3});
    EXPECT_FALSE(box.empty());
    EXPECT_EQ(box.low, (Vec3{1, -2, 3}));
    EXPECT_EQ(box.high, (Vec3{1, -2, 3}));
    EXPECT_EQ(box.center(), (Vec3{1, -2, 3}));
    EXPECT_EQ(box.diagonal(), 0);
    EXPECT_TRUE(box.overlaps(box));
}

TEST(Box3, ExtendsEveryAxisSeparately) {
    const Box3 box = two_corners();
    EXPECT_EQ(box.low, (Vec3{-1, 2, -2}));
    EXPECT_EQ(box.high, (Vec3{1, 5, 3}));
    EXPECT_EQ(box.size(), (Vec3{2, 3, 5}));
    EXPECT_EQ(box.center(), (Vec3{0, 3.5f, 0.5f}));
    EXPECT_FLOAT_EQ(box.diagonal(), std::sqrt(38.0f));  // 4 + 9 + 25
}

TEST(Box3, ContainsBothBoxesAfterExtend) {
    Box3 box = two_corners();
    Box3 other;
    other.extend(Vec3{0, 0, 0});
    other.extend(Vec3{0, 9, 1});
    box.extend(other);
    EXPECT_EQ(box.low, (Vec3{-1, 0, -2}));
    EXPECT_EQ(box.high, (Vec3{1, 9, 3}));
}

TEST(Box3, ExtendByAnEmptyBoxChangesNothing) {
    Box3 box = two_corners();
    box.extend(Box3{});
    EXPECT_EQ(box.low, two_corners().low);
    EXPECT_EQ(box.high, two_corners().high);
    Box3 none;
    none.extend(Box3{});
    EXPECT_TRUE(none.empty());
}

TEST(Box3, InflatedExtendsEverySide) {
    const Box3 box = two_corners().inflated(0.5f);
    EXPECT_EQ(box.low, (Vec3{-1.5f, 1.5f, -2.5f}));
    EXPECT_EQ(box.high, (Vec3{1.5f, 5.5f, 3.5f}));
}

TEST(Box3, OverlapsTouchingBoxesButNotSeparateOnes) {
    const Box3 unit{{0, 0, 0}, {1, 1, 1}};
    EXPECT_TRUE(unit.overlaps({{0.5f, 0.5f, 0.5f}, {2, 2, 2}}));
    EXPECT_TRUE(unit.overlaps({{1, 1, 1}, {2, 2, 2}}));  // a common corner
    for (int axis = 0; axis < 3; ++axis) {
        // Separated along one axis only, on either side.
        Box3 beyond = unit, before = unit;
        beyond.low[axis] = 1.5f;
        beyond.high[axis] = 2;
        before.low[axis] = -2;
        before.high[axis] = -0.5f;
        EXPECT_FALSE(unit.overlaps(beyond)) << axis;
        EXPECT_FALSE(beyond.overlaps(unit)) << axis;
        EXPECT_FALSE(unit.overlaps(before)) << axis;
    }
}

TEST(CapsuleBox, ContainsTheEndsWithTheRadiusAround) {
    const Box3 box = capsule_box({1, 0, -2}, {0, 3, 0}, 0.5f);
    EXPECT_EQ(box.low, (Vec3{-0.5f, -0.5f, -2.5f}));
    EXPECT_EQ(box.high, (Vec3{1.5f, 3.5f, 0.5f}));
}

}  // namespace
}  // namespace coppice
