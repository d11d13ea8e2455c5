#include "coppice/skeleton/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "zoo.h"

namespace coppice {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Measure, SumsConesAndCountsNodes) {
    // A trunk (0, 0, 0) - (0, 0, 3), radius 2 to 2, and two children: the leader with radius 2 -> 1 over a
    // length of 4, the other with a constant radius of 0.5 over a length of 2.
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 3}, {0, 0, 7}, {2, 0, 3}}, {2, 2, 1, 0.5f});
    const SkeletonMeasures m = measure(s);
    EXPECT_EQ(m.nodes, 4u);
    EXPECT_EQ(m.segments, 3u);
    EXPECT_EQ(m.trees, 1u);
    EXPECT_EQ(m.tips, 2u);
    EXPECT_EQ(m.branch_nodes, 1u);
    EXPECT_EQ(m.max_children, 2u);
    EXPECT_EQ(m.max_depth, 2u);
    EXPECT_DOUBLE_EQ(m.length, 9);
    EXPECT_DOUBLE_EQ(m.longest_path, 7);
    EXPECT_DOUBLE_EQ(m.shortest_segment, 2);
    EXPECT_DOUBLE_EQ(m.longest_segment, 4);
    EXPECT_NEAR(m.volume, kPi * (4 * 3 + 4.0 / 3 * (4 + 2 + 1) + 0.25 * 2), 1e-9);
    EXPECT_NEAR(m.area, kPi * (4 * 3 + 3 * std::sqrt(17.0) + 1 * 2), 1e-9);
    // Between the radii of parent and node the lateral is a cone from 2 to 0.5: a volume of 2 (4 + 1 + 0.25)
    // / 3 = 3.5, a sum of radii of 2.5, and a side of sqrt(1.5^2 + 2^2) = 2.5.
    EXPECT_NEAR(m.volume_frusta, kPi * (4 * 3 + 4.0 / 3 * (4 + 2 + 1) + 3.5), 1e-9);
    EXPECT_NEAR(m.area_frusta, kPi * (4 * 3 + 3 * std::sqrt(17.0) + 2.5 * 2.5), 1e-9);
    EXPECT_DOUBLE_EQ(m.min_radius, 0.5);
    EXPECT_DOUBLE_EQ(m.max_radius, 2);
    EXPECT_EQ(m.bounds.high, Vec3(2.5f, 2, 8));
}

TEST(Measure, AcceptsASingleNode) {
    const SkeletonMeasures m = measure(zoo_skeleton("single_node"));
    EXPECT_EQ(m.segments, 0u);
    EXPECT_EQ(m.tips, 1u);
    EXPECT_EQ(m.length + m.shortest_segment + m.longest_segment + m.volume, 0);
}

TEST(Measure, CountsAreConsistentOnTheZoo) {
    for (const auto& [name, s] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const SkeletonMeasures m = measure(s);
        EXPECT_EQ(m.segments + m.trees, m.nodes);
        EXPECT_LE(m.shortest_segment, m.longest_segment);
        EXPECT_LE(m.longest_path, m.length * (1 + 1e-12));
        EXPECT_LE(m.min_radius, m.max_radius);
        EXPECT_GE(m.tips, m.trees);
    }
}

}  // namespace
}  // namespace coppice
