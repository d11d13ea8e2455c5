#include "coppice/skeleton/branches.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/skeleton/architecture.h"
#include "coppice/skeleton/measure.h"
#include "zoo.h"

namespace coppice {
namespace {

constexpr double kPi = std::numbers::pi;

/// A stem 0-1-2 from 1 m up, of radius 0.2 to its fork and then 0.1; a lateral 3-4 from the fork, along +y,
/// of radius 0.05, with a twig 5 downwards from its first node; and a pole 6-7.
Skeleton forked_tree() {
    return Skeleton(
        {NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3), NodeId(3), NodeId::none(), NodeId(6)},
        {{0, 0, 1}, {0, 0, 3}, {0, 0, 5}, {0, 1, 3}, {0, 2, 3}, {0, 1, 2}, {9, 0, 0}, {9, 0, 4}},
        {0.2f, 0.2f, 0.1f, 0.05f, 0.05f, 0.02f, 0.3f, 0.1f});
}

TEST(Branches, HavePositionsSizesAndDirections) {
    const BranchTable table = list_branches(forked_tree());
    EXPECT_EQ(table.branch_of, (std::vector<std::uint32_t>{0, 0, 0, 1, 1, 2, 3, 3}));
    EXPECT_EQ(table.position_of, (std::vector<std::uint32_t>{0, 1, 2, 1, 2, 1, 0, 1}));
    ASSERT_EQ(table.branches.size(), 4u);

    const Branch& stem = table.branches[0];
    EXPECT_EQ(stem.parent, kNoIndex);
    EXPECT_EQ(stem.order, 0u);
    EXPECT_NEAR(stem.diameter, 0.4, 1e-7);
    EXPECT_DOUBLE_EQ(stem.length, 4);
    // a cylinder of 2 m, and a cone from 0.2 to 0.1 over 2 m: pi / 3 * 2 * (0.04 + 0.02 + 0.01)
    EXPECT_NEAR(stem.volume, kPi * (0.08 + 0.14 / 3), 1e-7);
    EXPECT_NEAR(stem.area, kPi * (0.8 + 0.3 * std::hypot(0.1, 2)), 1e-6);
    EXPECT_EQ(stem.height, 0);
    EXPECT_EQ(stem.angle, 0);
    EXPECT_EQ(stem.zenith, 0);

    const Branch& lateral = table.branches[1];
    EXPECT_EQ(lateral.parent, 0u);
    EXPECT_EQ(lateral.order, 1u);
    EXPECT_EQ(lateral.segments, 2u);
    EXPECT_NEAR(lateral.diameter, 0.1, 1e-7);
    EXPECT_NEAR(lateral.volume, kPi * 0.005, 1e-8);
    EXPECT_DOUBLE_EQ(lateral.height, 2);
    EXPECT_DOUBLE_EQ(lateral.angle, kPi / 2);
    EXPECT_DOUBLE_EQ(lateral.azimuth, kPi / 2);
    EXPECT_DOUBLE_EQ(lateral.zenith, kPi / 2);

    const Branch& twig = table.branches[2];
    EXPECT_EQ(twig.parent, 1u);
    EXPECT_EQ(twig.order, 2u);
    EXPECT_EQ(twig.tree, 0u);
    EXPECT_DOUBLE_EQ(twig.height, 2);
    EXPECT_DOUBLE_EQ(twig.zenith, kPi);
    EXPECT_EQ(table.branches[3].tree, 1u);
    EXPECT_EQ(table.branches[3].parent, kNoIndex);
}

TEST(Branches, FollowGivenAxes) {
    // The thin child continues the stem, and the thick one is a lateral of order 2.
    const std::vector<std::uint32_t> order{0, 0, 2, 0, 0, 3, 1, 1}, axis{5, 5, 7, 5, 5, 9, 6, 6};
    const BranchTable table = list_branches(forked_tree(), order, axis);
    EXPECT_EQ(table.branch_of, (std::vector<std::uint32_t>{0, 0, 1, 0, 0, 2, 3, 3}));
    EXPECT_EQ(table.position_of, (std::vector<std::uint32_t>{0, 1, 1, 2, 3, 1, 0, 1}));
    EXPECT_EQ(table.next_of[1], NodeId(3));
    EXPECT_EQ(table.next_of[4], NodeId::none());
    EXPECT_EQ(table.branches[1].order, 2u);
    EXPECT_EQ(table.branches[2].order, 3u);
    EXPECT_TRUE(table.branches[3].is_stem());
    EXPECT_EQ(table.branches[3].order, 1u);
    // The stem is 4 m long: 2 m up and 2 m sideways; that of the second tree 4 m.
    const auto timber = timber_volumes(forked_tree(), table, 0.001);
    EXPECT_DOUBLE_EQ(timber[0].stem_length, 4);
    EXPECT_DOUBLE_EQ(timber[1].stem_length, 4);
}

TEST(Branches, DirectionsIgnoreNodesInsideTheParentBranch) {
    // The lateral's first node is 0.1 up within the bark; beyond two radii (0.4) it runs along (1, 0, 1).
    const Skeleton tree({NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3)},
                        {{0, 0, 0}, {0, 0, 1}, {0, 0, 3}, {0, 0, 1.1f}, {1, 0, 2}},
                        {0.2f, 0.2f, 0.2f, 0.1f, 0.1f});
    EXPECT_NEAR(list_branches(tree).branches[1].angle, kPi / 4, 1e-12);
}

TEST(Branches, SumToTheSkeleton) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const BranchTable table = list_branches(skeleton);
        const std::vector<std::uint32_t> orders = axis_orders(skeleton);
        double length = 0, volume = 0;
        std::uint32_t segments = 0;
        for (const Branch& b : table.branches) {
            length += b.length;
            volume += b.volume;
            segments += b.segments;
            EXPECT_TRUE(std::isfinite(b.angle + b.azimuth + b.zenith));
        }
        const SkeletonMeasures m = measure(skeleton);
        EXPECT_NEAR(length, m.length, 1e-9 * m.length);
        EXPECT_NEAR(volume, m.volume, 1e-9 * m.volume);
        EXPECT_EQ(segments, m.segments);
        for (const NodeId n : nodes(skeleton))
            EXPECT_EQ(table.branches[table.branch_of[n.index()]].order, orders[n.index()]);
    }
}

TEST(Branches, TimberEndsAtTheTopDiameter) {
    const Skeleton trees = forked_tree();
    const BranchTable table = list_branches(trees);
    const double whole = kPi * (0.08 + 0.14 / 3);
    // The whole first stem is thicker than 0.15; the lateral is not. A stump of 0.5 m subtracts 0.5 pi 0.04.
    std::vector<TimberVolume> timber = timber_volumes(trees, table, 0.15, 0.5);
    EXPECT_NEAR(timber[0].stem_length, 3.5, 1e-7);
    EXPECT_NEAR(timber[0].stem_volume, whole - kPi * 0.02, 1e-7);
    EXPECT_NEAR(timber[0].volume, timber[0].stem_volume, 1e-7);
    // The cone from 0.4 to 0.2 over 2 m has 0.3 in its middle: pi / 3 * (0.04 + 0.03 + 0.0225) remains of it.
    timber = timber_volumes(trees, table, 0.3);
    EXPECT_NEAR(timber[0].stem_length, 3, 1e-6);
    EXPECT_NEAR(timber[0].stem_volume, kPi * (0.08 + 0.0925 / 3), 1e-7);
    // The cone of the pole from 0.6 to 0.2 over 4 m after 3 m: pi / 3 * 3 * (0.09 + 0.045 + 0.0225).
    EXPECT_NEAR(timber[1].stem_length, 3, 1e-6);
    EXPECT_NEAR(timber[1].stem_volume, kPi * 0.1575, 1e-7);
    // With 0.1 the lateral counts as timber, and not as stem; no segment is as thick as a metre.
    timber = timber_volumes(trees, table, 0.099);
    EXPECT_NEAR(timber[0].volume, whole + kPi * 0.005, 1e-7);
    EXPECT_NEAR(timber[0].stem_volume, whole, 1e-7);
    EXPECT_EQ(timber_volumes(trees, table, 1)[0].volume, 0);
    EXPECT_EQ(timber_volumes(trees, table, 1)[0].stem_length, 0);
}

TEST(Branches, StemsContinueAboveAThinSection) {
    // Diameters 0.4, 0.1, 0.4, 0.1 a metre apart: 0.25 is last reached halfway up the third segment. Half of
    // each segment, from 0.4 to 0.25, has that diameter.
    const Skeleton pole({NodeId::none(), NodeId(0), NodeId(1), NodeId(2)},
                        {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}}, {0.2f, 0.05f, 0.2f, 0.05f});
    const TimberVolume timber = timber_volumes(pole, list_branches(pole), 0.25)[0];
    const double half = kPi / 3 * 0.5 * (0.04 + 0.025 + 0.015625);
    EXPECT_NEAR(timber.stem_length, 2.5, 1e-6);
    EXPECT_NEAR(timber.volume, 3 * half, 1e-7);
    EXPECT_GT(timber.stem_volume, timber.volume);
}

TEST(Branches, TimberRejectsInvalidDiameters) {
    const Skeleton trees = forked_tree();
    const BranchTable table = list_branches(trees);
    EXPECT_THROW(timber_volumes(trees, table, 0), InvalidInput);
    EXPECT_THROW(timber_volumes(trees, table, std::nan("")), InvalidInput);
    EXPECT_THROW(timber_volumes(trees, table, 0.1, -1), InvalidInput);
}

}  // namespace
}  // namespace coppice
