#include "coppice/skeleton/edit_internal.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/skeleton/measure.h"
#include "zoo.h"

namespace coppice {
namespace {

TEST(SmoothRadii, AveragesHalfOfItselfAndAQuarterOfEachNeighbour) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(2)},
                     {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}}, {4, 2, 4, 1});
    const EditResult one = smooth_radii(s, 1);
    EXPECT_EQ(one.count, 2u);
    EXPECT_FLOAT_EQ(one.skeleton.radius(NodeId(0)), 4);
    EXPECT_FLOAT_EQ(one.skeleton.radius(NodeId(1)), 3);      // 2 / 2 + (4 + 4) / 4
    EXPECT_FLOAT_EQ(one.skeleton.radius(NodeId(2)), 2.75f);  // 4 / 2 + (2 + 1) / 4
    EXPECT_FLOAT_EQ(one.skeleton.radius(NodeId(3)), 1);
    EXPECT_EQ(smooth_radii(s, 0).count, 0u);
}

TEST(SmoothRadii, PreservesTheLeader) {
    for (const auto& [name, s] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const Skeleton smooth = smooth_radii(s, 5).skeleton;
        for (const NodeId n : nodes(s)) EXPECT_EQ(s.leader(n), smooth.leader(n));
    }
}

/// A trunk with branch nodes at z = 4 and z = 4 + gap, with a chain node between them.
Skeleton two_forks(float gap) {
    return Skeleton(
        {NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(2), NodeId(4), NodeId(4)},
        {{0, 0, 0}, {0, 0, 4}, {0, 0, 4 + gap / 2}, {5, 0, 4}, {0, 0, 4 + gap}, {0, 5, 6}, {0, 0, 9}},
        {1, 1, 0.9f, 0.3f, 0.9f, 0.3f, 0.5f});
}

TEST(MergeCloseBranches, MergedNodeHasTheChildrenOfBoth) {
    const EditResult r = merge_close_branches(two_forks(0.4f));
    EXPECT_EQ(r.count, 1u);
    ASSERT_EQ(r.skeleton.size(), 5u);
    EXPECT_EQ(r.skeleton.children(NodeId(1)).size(), 3u);
    EXPECT_EQ(r.skeleton.position(NodeId(1)), Vec3(0, 0, 4));
    EXPECT_EQ(r.new_of_old[2], NodeId(1));
    EXPECT_EQ(r.new_of_old[4], NodeId(1));
    EXPECT_EQ(r.new_of_old[6], NodeId(4));
}

TEST(MergeCloseBranches, PreservesDistantNodes) {
    const EditResult r = merge_close_branches(two_forks(0.6f));
    EXPECT_EQ(r.count, 0u);
    EXPECT_EQ(r.skeleton.size(), 7u);
    EXPECT_EQ(merge_close_branches(two_forks(0.6f), 0.7f).count, 1u);
}

TEST(MergeCloseBranches, NoCloseNodesRemainAndTipsArePreserved) {
    for (const auto& [name, s] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const EditResult r = merge_close_branches(s);
        EXPECT_EQ(measure(r.skeleton).tips, measure(s).tips);
        EXPECT_EQ(measure(r.skeleton).trees, measure(s).trees);
        EXPECT_EQ(measure(r.skeleton).branch_nodes + r.count, measure(s).branch_nodes);
        for (const NodeId n : r.new_of_old) EXPECT_LT(n.index(), r.skeleton.size());
        for (const NodeId n : nodes(r.skeleton)) {
            const NodeId p = r.skeleton.parent(n);
            if (!p || r.skeleton.children(n).size() < 2 || r.skeleton.children(p).size() < 2) continue;
            const float room = 0.5f * std::max(r.skeleton.radius(n), r.skeleton.radius(p));
            EXPECT_GE(distance(r.skeleton.position(n), r.skeleton.position(p)), room);
        }
    }
}

TEST(SplitCrowdedNodes, LimitsTheChildrenOfEveryNode) {
    for (const auto& [name, s] : skeleton_zoo()) {
        for (const int most : {2, 3, 5}) {
            SCOPED_TRACE(name + " " + std::to_string(most));
            const EditResult r = split_crowded_nodes(s, most);
            EXPECT_LE(measure(r.skeleton).max_children, static_cast<std::uint32_t>(most));
            EXPECT_EQ(measure(r.skeleton).tips, measure(s).tips);
            EXPECT_EQ(r.skeleton.size(), s.size() + r.count);
            for (const NodeId n : nodes(s)) {
                EXPECT_EQ(r.skeleton.position(r.new_of_old[n.index()]), s.position(n));
                EXPECT_EQ(r.skeleton.radius(r.new_of_old[n.index()]), s.radius(n));
            }
        }
    }
}

TEST(SplitCrowdedNodes, NewNodesContinueTheLeader) {
    // Eight children, three slots: two laterals at each of three nodes, then two children at the last: 8 = 3
    // * 2 + 2.
    const Skeleton s = zoo_skeleton("whorl_8");
    const EditResult r = split_crowded_nodes(s, 3);
    EXPECT_EQ(r.count, 3u);
    NodeId n = r.new_of_old[1];
    for (const std::size_t children : {3u, 3u, 3u, 2u}) {
        EXPECT_EQ(r.skeleton.children(n).size(), children);
        n = r.skeleton.leader(n);
    }
}

TEST(SplitCrowdedNodes, RejectsAMaximumBelowTwo) {
    EXPECT_THROW(split_crowded_nodes(zoo_skeleton("soma"), 1), InvalidInput);
}

}  // namespace
}  // namespace coppice
