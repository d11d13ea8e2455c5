#include "coppice/extract/plot/crown.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace coppice {
namespace {

TEST(Crown, MatchesABoxOfPoints) {
    // 2 x 1 x 1 m above z = 13, and a stem below, which is ignored.
    PointSet points{{}, {500000, 5400000, 10}};
    for (int i = 0; i < 8; ++i)
        points.positions.emplace_back(float(2 * (i & 1)), float((i >> 1) & 1), float(3 + (i >> 2)));
    points.positions.emplace_back(1.f, 0.5f, 3.5f);
    points.positions.emplace_back(9.f, 9.f, 0.f);
    const Crown crown = measure_crown(points, 13);
    EXPECT_EQ(
        crown.outline,
        (std::vector<Vec3d>{
            {500000, 5400000, 13}, {500002, 5400000, 13}, {500002, 5400001, 13}, {500000, 5400001, 13}}));
    EXPECT_DOUBLE_EQ(crown.area, 2);
    EXPECT_DOUBLE_EQ(crown.max_width, std::sqrt(5));
    EXPECT_DOUBLE_EQ(crown.diameter(), 2 * std::sqrt(2 / std::numbers::pi));
    EXPECT_NEAR(crown.hull_volume, 2, 1e-9);
    EXPECT_NEAR(crown.hull_area, 10, 1e-9);
    EXPECT_EQ(crown.hull.origin, points.origin);
}

TEST(Crown, WidthIsTheMaximumDistanceOfCorners) {
    // A slanted strip, a triangle with its maximum width along one side, and a regular polygon.
    const auto width = [](std::vector<Vec3> corners) {
        PointSet points{{}, {}};
        points.positions.assign(corners.begin(), corners.end());
        return measure_crown(points, -1).max_width;
    };
    EXPECT_DOUBLE_EQ(width({{0, 0, 0}, {1, 0, 0}, {10, 1, 0}, {9, 1, 0}}), std::sqrt(101));
    EXPECT_DOUBLE_EQ(width({{0, 0, 0}, {5, 0, 0}, {1, 1, 0}}), 5);
    EXPECT_DOUBLE_EQ(width({{0, 0, 0}, {9, 0, 0}, {8, 1, 0}, {-3, 1, 0}}), std::sqrt(145));
    std::vector<Vec3> polygon;
    for (int i = 0; i < 36; ++i)
        polygon.emplace_back(float(std::cos(i * std::numbers::pi / 18)),
                             float(std::sin(i * std::numbers::pi / 18)), 0.f);
    EXPECT_NEAR(width(polygon), 2, 1e-6);
}

TEST(Crown, IsEmptyWithoutAnOutline) {
    PointSet points{{}, {}};
    points.positions.assign(5, Vec3{1, 1, 4});
    for (const double above : {0.0, 9.0}) {
        const Crown crown = measure_crown(points, above);
        EXPECT_TRUE(crown.outline.empty());
        EXPECT_EQ(crown.area, 0);
        EXPECT_EQ(crown.max_width, 0);
        EXPECT_EQ(crown.hull_volume, 0);
    }
}

TEST(Crown, BasesAreComputedPerTree) {
    // A stem of 4 m with a branch of 1 m at 2 m and a twig of 0.3 m below it; then a bare pole of 3 m.
    const Skeleton trees(
        {NodeId::none(), NodeId(0), NodeId(1), NodeId(2), NodeId(1), NodeId(2), NodeId::none(), NodeId(6)},
        {{0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 5}, {0.3f, 0, 2}, {0, 1, 3}, {9, 0, 0}, {9, 0, 3}},
        {0.2f, 0.2f, 0.15f, 0.1f, 0.01f, 0.05f, 0.1f, 0.1f});
    const std::vector<StemForm> forms = stem_forms(trees);
    ASSERT_EQ(forms.size(), 2u);
    const std::vector<double> bases = crown_bases(trees, forms);
    EXPECT_DOUBLE_EQ(bases[0], 2);
    EXPECT_DOUBLE_EQ(bases[1], forms[1].height);
    // The ends of twig and branch and the stem of the first tree form a triangle; the pole has no outline.
    const std::vector<Crown> crowns = measure_crowns(trees, std::vector<double>{0, 0});
    EXPECT_NEAR(crowns[0].area, 0.15, 1e-7);
    EXPECT_EQ(crowns[1].area, 0);
}

}  // namespace
}  // namespace coppice
