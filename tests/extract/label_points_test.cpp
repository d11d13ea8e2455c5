#include "coppice/extract/tree/label_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace coppice {
namespace {

/// Returns a stem of 2 m, 0.1 m thick, and a lateral at 1 m with a mostly inferred radius.
ExtractResult tree() {
    const std::vector<NodeId> parents{NodeId::none(), NodeId(0), NodeId(1), NodeId(1)};
    ExtractResult out{Skeleton(parents, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {1, 0, 1}},
                               {0.1f, 0.1f, 0.1f, 0.04f}, {500000, 4000000, 100}),
                      std::vector<NodeConfidence>(4),
                      {}};
    out.confidence[3].evidence = 0.25f;
    return out;
}

PointCloud points_at(std::vector<Vec3> places) {
    PointCloud out{{{}, {500001, 4000000, 100}}, {}, {}};
    for (const Vec3 p : places) out.points.positions.push_back(p - Vec3(1, 0, 0));
    return out;
}

TEST(LabelPoints, WoodIsNearTheSurfaceOfTheClosestBranch) {
    PointCloud scan =
        points_at({{-0.1f, 0, 0.5f}, {0.7f, 0.05f, 1}, {0.7f, 0.2f, 1}, {0, 0, 0.5f}, {0, 3, 1}});
    const std::vector<std::uint32_t> which{0, 1, 2, 3};
    label_points(scan, which, tree(), 0.01);
    EXPECT_EQ(scan.wood, (std::vector<std::uint8_t>{1, 1, 0, 0, 0}));
    EXPECT_EQ(scan.branch_orders, (std::vector<std::uint8_t>{0, 1, 1, 0, 0}));
    EXPECT_EQ(scan.evidence, (std::vector<float>{1, 0.25f, 0.25f, 1, 0}));
    EXPECT_NEAR(scan.distances[0], 0, 1e-6);
    EXPECT_NEAR(scan.distances[3], -0.1, 1e-6);
    EXPECT_TRUE(std::isnan(scan.distances[4]));
}

TEST(LabelPoints, SpacingIncreasesTheToleranceOfWood) {
    PointCloud scan = points_at({{0.7f, 0.2f, 1}});
    label_points(scan, std::vector<std::uint32_t>{0}, tree(), 0.33);
    EXPECT_EQ(scan.wood, (std::vector<std::uint8_t>{1}));
}

TEST(LabelPoints, LabelsThePointsOfEachTreeOfAPlot) {
    PointCloud scan = points_at({{-0.1f, 0, 0.5f}, {0.1f, 0, 0.5f}});
    label_points(scan, std::vector<std::uint32_t>{0}, tree(), 0.01);
    label_points(scan, std::vector<std::uint32_t>{1}, tree(), 0.01);
    EXPECT_EQ(scan.wood, (std::vector<std::uint8_t>{1, 1}));
}

TEST(LabelPoints, SkeletonWithoutSegmentsLabelsNoWood) {
    PointCloud scan = points_at({{0, 0, 0}});
    const ExtractResult point{
        Skeleton({NodeId::none()}, {{0, 0, 0}}, {1}), std::vector<NodeConfidence>(1), {}};
    label_points(scan, std::vector<std::uint32_t>{0}, point, 0.01);
    EXPECT_EQ(scan.wood, (std::vector<std::uint8_t>{0}));
    EXPECT_TRUE(std::isnan(scan.distances[0]));
}

}  // namespace
}  // namespace coppice
