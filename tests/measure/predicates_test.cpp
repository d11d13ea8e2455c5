#include "coppice/measure/predicates_internal.h"

#include <gtest/gtest.h>

#include <limits>

namespace coppice {
namespace {

constexpr Vec3 kO{0, 0, 0}, kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

TEST(Orientation, IsPositiveForUnitVectors) {
    EXPECT_EQ(orientation(kO, kX, kY, kZ), 1);
    EXPECT_EQ(orientation(kO, kY, kX, kZ), -1);
    EXPECT_EQ(orientation(kO, kX, kY, {5, -7, 0}), 0);
    EXPECT_EQ(orientation_2d(kO, kX, kY, 2), 1);
    EXPECT_EQ(orientation_2d(kO, kY, kZ, 0), 1);
    EXPECT_EQ(orientation_2d(kO, kZ, kX, 1), 1);
    EXPECT_EQ(orientation_2d(kO, kX, {3, 0, 9}, 2), 0);
}

TEST(Orientation, DetectsTheSmallestOffsetFromAPlane) {
    // The plane x + y + z = 3 through points that are exact in single precision; a step of one ulp in one
    // coordinate leaves it.
    const Vec3 a{1, 1, 1}, b{1 + 0x1p-20f, 1 - 0x1p-20f, 1}, c{1, 1 + 0x1p-22f, 1 - 0x1p-22f};
    const Vec3 d{1 + 0x1p-18f, 1, 1 - 0x1p-18f};
    EXPECT_EQ(orientation(a, b, c, d), 0);
    const int up = orientation(a, b, c, {d.x, d.y, std::nextafter(d.z, 2.f)});
    const int down = orientation(a, b, c, {d.x, d.y, std::nextafter(d.z, 0.f)});
    EXPECT_NE(up, 0);
    EXPECT_EQ(up, -down);
}

TEST(Orientation, AcceptsExtremeNumbers) {
    constexpr float kMax = std::numeric_limits<float>::max(), kMin = std::numeric_limits<float>::denorm_min();
    EXPECT_EQ(orientation({}, {kMax, 0, 0}, {0, kMax, 0}, {0, 0, kMin}), 1);
    EXPECT_EQ(orientation({-kMax, -kMax, 0}, {kMax, -kMax, 0}, {kMax, kMax, 0}, {-kMax, kMax, -kMin}), -1);
    EXPECT_EQ(orientation({}, {kMin, 0, 0}, {0, kMin, 0}, {0, 0, kMin}), 1);
    EXPECT_EQ(orientation_2d({}, {kMin, 0, 0}, {0, kMin, 0}, 2), 1);
    EXPECT_EQ(orientation_2d({-kMax, -kMax, 0}, {kMax, kMax, 0}, {kMin, 0, 0}, 2), -1);
}

TEST(Triangles, AreDegenerateIfCollinear) {
    EXPECT_TRUE(is_degenerate({kO, kX, {2, 0, 0}}));
    EXPECT_TRUE(is_degenerate({kO, kO, kZ}));
    EXPECT_TRUE(is_degenerate({Vec3{0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.2f}, {0.7f, 0.7f, 0.7f}}));
    EXPECT_FALSE(
        is_degenerate({Vec3{0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.2f}, {0.7f, 0.7f, std::nextafter(0.7f, 1.f)}}));
}

constexpr TrianglePoints kFloor{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};

TEST(Triangles, MeetInALineOrAPoint) {
    EXPECT_TRUE(triangles_meet(kFloor, {Vec3{1, 1, -1}, Vec3{1, 1, 1}, Vec3{9, 9, 0}}));  // intersects
    EXPECT_TRUE(
        triangles_meet(kFloor, {Vec3{1, 1, 0}, Vec3{1, 1, 1}, Vec3{1, 2, 1}}));  // touches it with a corner
    EXPECT_TRUE(triangles_meet(kFloor, {Vec3{2, 2, 0}, Vec3{5, 5, 1}, Vec3{5, 5, -1}}));  // touches the rim
    EXPECT_FALSE(triangles_meet(kFloor, {Vec3{1, 1, 1}, Vec3{1, 2, 1}, Vec3{2, 1, 0x1p-20f}}));
    EXPECT_FALSE(
        triangles_meet(kFloor, {Vec3{3, 3, -1}, Vec3{3, 3, 1}, Vec3{9, 9, 0}}));  // passes next to it
}

TEST(Triangles, CoplanarTrianglesMeetIfTheyOverlap) {
    EXPECT_TRUE(triangles_meet(kFloor, {Vec3{1, 1, 0}, Vec3{1.5f, 1, 0}, Vec3{1, 1.5f, 0}}));  // is inside
    EXPECT_TRUE(triangles_meet({Vec3{1, 1, 0}, Vec3{1.5f, 1, 0}, Vec3{1, 1.5f, 0}},
                               kFloor));  // and the other way round
    EXPECT_TRUE(triangles_meet(kFloor, {Vec3{4, 0, 0}, Vec3{5, 0, 0}, Vec3{5, 1, 0}}));  // a corner
    EXPECT_TRUE(
        triangles_meet(kFloor, {Vec3{1, 0, 0}, Vec3{3, 0, 0}, Vec3{2, -1, 0}}));  // a portion of an edge
    EXPECT_FALSE(triangles_meet(kFloor, {Vec3{5, 0, 0}, Vec3{6, 0, 0}, Vec3{5, 1, 0}}));
    EXPECT_FALSE(triangles_meet(kFloor, {Vec3{2.5f, 2.5f, 0}, Vec3{6, 0, 0}, Vec3{6, 6, 0}}));
}

TEST(Triangles, WithACommonCornerMeetBeyondIt) {
    EXPECT_FALSE(triangles_meet_beyond_corner(kFloor, {kO, {1, 1, 1}, {1, 2, 1}}));
    EXPECT_FALSE(triangles_meet_beyond_corner(kFloor, {kO, {-1, -1, 1}, {-1, -1, -1}}));
    EXPECT_TRUE(triangles_meet_beyond_corner(kFloor, {kO, {1, 1, 1}, {1, 1, -1}}));
    EXPECT_TRUE(triangles_meet_beyond_corner(kFloor, {kO, {9, 9, 1}, {9, 9, -1}}));
    EXPECT_TRUE(triangles_meet_beyond_corner(kFloor, {kO, {1, 1, 0}, {1, 1, 5}}));
    EXPECT_TRUE(triangles_meet_beyond_corner(kFloor, {kO, {1, 0, 0}, {1, -1, 0}}));    // flat, along an edge
    EXPECT_FALSE(triangles_meet_beyond_corner(kFloor, {kO, {-1, 0, 0}, {0, -1, 0}}));  // flat, opposite
}

TEST(Triangles, WithACommonEdgeOverlapIfFolded) {
    EXPECT_FALSE(triangles_overlap_beyond_edge(kFloor, {kFloor[0], kFloor[1], {1, -1, 0}}));
    EXPECT_TRUE(triangles_overlap_beyond_edge(kFloor, {kFloor[0], kFloor[1], {1, 1, 0}}));
    EXPECT_FALSE(triangles_overlap_beyond_edge(kFloor, {kFloor[0], kFloor[1], {1, 1, 0x1p-100f}}));
}

}  // namespace
}  // namespace coppice
