#include "coppice/skeleton/skeleton.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "coppice/base/error.h"
#include "zoo.h"

namespace coppice {
namespace {

const NodeId kNoNode = NodeId::none();

TEST(Skeleton, HasChildrenLeadersAndTips) {
    // 0 - 1 - 2, and 3, 4 from 1; 5 alone. The leader of 1 is 3: the thickest, and before 4.
    const Skeleton s({kNoNode, NodeId(0), NodeId(1), NodeId(1), NodeId(1), kNoNode}, std::vector<Vec3>(6),
                     {5, 4, 1, 2, 2, 1});
    EXPECT_EQ(s.tree_count(), 2u);
    ASSERT_EQ(s.children(NodeId(1)).size(), 3u);
    EXPECT_EQ(s.children(NodeId(1))[2], NodeId(4));
    EXPECT_EQ(s.leader(NodeId(1)), NodeId(3));
    EXPECT_FALSE(s.leader(NodeId(2)));
    EXPECT_TRUE(s.is_tip(NodeId(5)) && s.is_root(NodeId(5)));
}

TEST(Skeleton, HasNoNodesByDefault) {
    const Skeleton none;
    EXPECT_EQ(none.size(), 0u);
    EXPECT_EQ(none.tree_count(), 0u);
    for (const NodeId n : nodes(none)) ADD_FAILURE() << n.index();
}

TEST(Skeleton, OnlyTheLeaderStartsWithItsParentsRadius) {
    const Skeleton s({kNoNode, NodeId(0), NodeId(0)}, std::vector<Vec3>(3), {5, 1, 2});
    EXPECT_EQ(s.segment(NodeId(1)).radius_a, 1);
    EXPECT_EQ(s.segment(NodeId(2)).radius_a, 5);
}

TEST(Skeleton, RejectsInputThatBreaksAnInvariant) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(Skeleton({}, {}, {}), InvalidInput);
    EXPECT_THROW(Skeleton({NodeId(0)}, {{}}, {1}), InvalidInput);
    EXPECT_THROW(Skeleton({NodeId(1), kNoNode}, {{}, {}}, {1, 1}), InvalidInput);
    EXPECT_THROW(Skeleton({kNoNode}, {{nan, 0, 0}}, {1}), InvalidInput);
    for (const float radius : {0.0f, -1.0f, nan, std::numeric_limits<float>::infinity()}) {
        EXPECT_THROW(Skeleton({kNoNode}, {{}}, {radius}), InvalidInput);
    }
}

TEST(Zoo, NamesAreUniqueAndSkeletonsAreReproducible) {
    std::set<std::string> names;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        EXPECT_TRUE(names.insert(name).second) << name;
        const Skeleton again = zoo_skeleton(name);
        EXPECT_TRUE(std::equal(skeleton.positions().begin(), skeleton.positions().end(),
                               again.positions().begin(), again.positions().end()));
    }
    EXPECT_GE(names.size(), 40u);
}

}  // namespace
}  // namespace coppice
