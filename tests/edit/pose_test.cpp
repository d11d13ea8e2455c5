#include "coppice/edit/animate/pose.h"

#include <gtest/gtest.h>

#include "coppice/skeleton/random_tree.h"

namespace coppice {
namespace {

// Rotates every segment relative to its parent by an angle.
Pose bent(const Skeleton& s, double angle) {
    Pose out = rest_pose(s);
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const std::uint32_t i = n.index(), p = s.parent(n).index();
        out.turns[i] = unit(rotation_about({0, 1, 0}, angle) * out.turns[p]);
        out.positions[i] =
            Vec3(Vec3d(out.positions[p]) + out.turns[i](Vec3d(s.position(n)) - Vec3d(s.positions()[p])));
    }
    return out;
}

// Returns the position of a node relative to its parent.
Vec3d seen_from_parent(const Skeleton& s, const Pose& pose, NodeId n) {
    const std::uint32_t i = n.index(), p = s.parent(n).index();
    return inverse(pose.turns[p])(Vec3d(pose.positions[i]) - Vec3d(pose.positions[p]));
}

TEST(Pose, RestPoseReproducesTheSkeleton) {
    const Skeleton s = random_tree(50, 1);
    const Skeleton same = posed(s, rest_pose(s));
    EXPECT_TRUE(std::ranges::equal(same.positions(), s.positions()));
    EXPECT_TRUE(std::ranges::equal(same.parents(), s.parents()));
}

TEST(Pose, FreezeWithoutFrozenNodesReturnsTheWantedPose) {
    const Skeleton s = random_tree(80, 2);
    const Pose wanted = bent(s, 0.1);
    EXPECT_EQ(freeze(s, wanted, rest_pose(s), std::vector<std::uint8_t>(s.size())), wanted);
}

TEST(Pose, InterpolationPreservesLengthsAndMatchesBothEnds) {
    const Skeleton s = random_tree(100, 4);
    const Pose rest = rest_pose(s), far = bent(s, 0.4);
    for (std::size_t i = 0; i < s.size(); ++i) {
        EXPECT_LT(distance(on_the_way(s, rest, far, 0).positions[i], rest.positions[i]), 1e-5f);
        EXPECT_LT(distance(on_the_way(s, rest, far, 1).positions[i], far.positions[i]), 1e-4f);
    }
    const Pose half = on_the_way(s, rest, far, 0.5);
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const std::uint32_t i = n.index(), p = s.parent(n).index();
        EXPECT_NEAR(distance(half.positions[i], half.positions[p]),
                    distance(s.positions()[i], s.positions()[p]), 1e-4f);
    }
}

TEST(Pose, FrozenNodesPreserveTheirPoseRelativeToTheirParents) {
    const Skeleton s = random_tree(200, 3);
    const Pose last = bent(s, 0.05), wanted = bent(s, 0.2);
    std::vector<std::uint8_t> is_frozen(s.size());
    for (std::uint32_t i = 0; i < s.size(); i += 7) is_frozen[i] = 1;
    const Pose now = freeze(s, wanted, last, is_frozen);
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const Vec3d as = seen_from_parent(s, is_frozen[n.index()] != 0 ? last : wanted, n);
        EXPECT_LT(distance(seen_from_parent(s, now, n), as), 1e-5);
    }
}

TEST(Pose, FreezesThePathBetweenTwoNodesButNotTheirFork) {
    // 0 - 1 - 2, 1 - 3 - 4
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3)},
                     {{0, 0, 0}, {0, 0, 1}, {1, 0, 2}, {-1, 0, 2}, {-2, 0, 3}}, std::vector<float>(5, 0.1f));
    std::vector<std::uint8_t> is_frozen(5);
    freeze_between(s, NodeId(2), NodeId(4), is_frozen);
    EXPECT_EQ(is_frozen, (std::vector<std::uint8_t>{0, 0, 1, 1, 1}));
}

TEST(Pose, FreezesThePathsToTheRootsInTwoTrees) {
    const Skeleton s({NodeId::none(), NodeId::none(), NodeId(0), NodeId(1)},
                     {{0, 0, 0}, {5, 0, 0}, {0, 0, 1}, {5, 0, 1}}, std::vector<float>(4, 0.1f));
    std::vector<std::uint8_t> is_frozen(4);
    freeze_between(s, NodeId(2), NodeId(3), is_frozen);
    EXPECT_EQ(is_frozen, (std::vector<std::uint8_t>{1, 1, 1, 1}));
}

}  // namespace
}  // namespace coppice
