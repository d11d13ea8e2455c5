#include "coppice/cage/graft.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "coppice/base/kernel/segment_distance.h"
#include "coppice/skeleton/measure.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

namespace coppice {
namespace {

constexpr float kDepth = 0.6f;

// A stem, a long loop, and a branch that returns and passes the stem at the given distance.
Skeleton loop(float offset, float radius = 0.05f) {
    return {{NodeId::none(), NodeId(0), NodeId(1), NodeId(2), NodeId(3), NodeId(4)},
            {{0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, offset, 2}, {1, offset, 2}, {-2, offset, 2}},
            {0.1f, 0.1f, 0.1f, radius, radius, radius}};
}

double axis_distance(const Skeleton& s, NodeId a, NodeId b) {
    const auto at = [&](NodeId n) { return Vec3d(s.position(n)); };
    return segment_distance(at(s.parent(a)), at(a), at(s.parent(b)), at(b));
}

float segment_length(const Skeleton& s, NodeId n) {
    return s.is_root(n) ? 0 : distance(s.position(n), s.position(s.parent(n)));
}

// Properties of any result: maps in range, tubes at the positions of their sources, unchanged lengths.
void expect_sound(const Skeleton& given, const GraftResult& r) {
    ASSERT_EQ(r.source.size(), r.tubes.size());
    ASSERT_EQ(r.tube.size(), r.skeleton.size());
    EXPECT_EQ(r.tubes.tree_count() + r.report.joined, given.tree_count());
    float before = 0, after = 0;
    for (const NodeId n : nodes(given)) before += segment_length(given, n);
    for (const NodeId n : nodes(r.skeleton)) after += segment_length(r.skeleton, n);
    EXPECT_NEAR(after, before, 1e-4f * before);
    for (const NodeId n : nodes(r.tubes)) ASSERT_LT(r.source[n.index()].index(), r.skeleton.size());
    for (const NodeId t : r.tube) {
        ASSERT_TRUE(!t || t.index() < r.tubes.size());
    }
}

TEST(GraftBranches, ClosedPieceEndsAtTheBarkAndTheRestStartsThere) {
    for (const float offset : {0.0f, 0.02f, 0.08f}) {
        const Skeleton s = loop(offset);
        const GraftResult r = graft_branches(s, kDepth, SectionEnd::closed, {});
        expect_sound(s, r);
        EXPECT_EQ(r.report.grafted, 1u);
        EXPECT_EQ(r.report.truncated, 1u);
        std::size_t tips = 0;
        for (const NodeId n : nodes(r.tubes)) {
            if (!r.tubes.is_tip(n)) continue;
            ++tips;
            const Vec3 p = r.tubes.position(n);
            const bool given_tip = p == s.position(NodeId(5));
            const bool at_bark = std::abs(std::hypot(p.x, p.y) - 0.125f) < 0.02f && p.x > 0;
            EXPECT_TRUE(given_tip || at_bark) << p.x << " " << p.y << " " << p.z;
        }
        EXPECT_EQ(tips, 2u);
    }
}

TEST(GraftBranches, JoinedPieceEndsAtANodeOfTheOtherBranch) {
    for (const float offset : {0.0f, 0.02f, 0.08f}) {
        const Skeleton s = loop(offset);
        const GraftResult r = graft_branches(s, kDepth, SectionEnd::joined, {});
        expect_sound(s, r);
        EXPECT_EQ(r.report.grafted, 1u);
        EXPECT_EQ(r.report.truncated, 0u);
        EXPECT_EQ(r.report.merged, 1u);
        ASSERT_EQ(r.joins.size(), 1u);
        const auto [end, node] = r.joins[0];
        EXPECT_TRUE(r.tubes.is_tip(end));
        EXPECT_EQ(r.tubes.position(end), r.tubes.position(node));
        EXPECT_EQ(r.tubes.position(node).x, 0) << "on the axis of the stem";
        EXPECT_EQ(r.tubes.children(node).size(), 2u) << "the stem continues, and the branch begins there";
    }
}

// Equal limbs that cross, cut into segments: one continues without interruption, for any thickness of
// segments there.
TEST(GraftBranches, OneOfTwoEqualBranchesContinuesThroughTheCrossing) {
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    for (const float side : {1.0f, -1.0f}) {
        for (int k = 0; k <= 8; ++k) {
            parent.push_back(k == 0 ? NodeId::none() : NodeId(static_cast<std::uint32_t>(parent.size() - 1)));
            const float at = 0.25f * static_cast<float>(k) + (side > 0 ? 0.1f : 0);
            position.push_back({side * (at - 1), 0, at});
            radius.push_back(0.08f - 0.01f * at);
        }
    }
    const GraftResult r = graft_branches({parent, position, radius}, kDepth, SectionEnd::joined, {});
    EXPECT_EQ(r.report.grafted, 1u);
    EXPECT_EQ(r.joins.size(), 1u);
    EXPECT_EQ(r.tubes.tree_count(), 2u);
}

TEST(GraftBranches, ResultHasNoIntersectingTubes) {
    const GraftResult r = graft_branches(loop(0.03f), kDepth, SectionEnd::closed, {});
    for (const NodeId a : nodes(r.tubes)) {
        for (const NodeId b : nodes(r.tubes)) {
            if (r.tubes.is_root(a) || r.tubes.is_root(b) || a >= b) continue;
            const std::set<NodeId> ends{a, b, r.tubes.parent(a), r.tubes.parent(b)};
            EXPECT_TRUE(ends.size() < 4 || axis_distance(r.tubes, a, b) > 0.09);
        }
    }
}

TEST(GraftBranches, ThickBranchCutsTheThinStem) {
    // The loop is the thick one now: it cuts the stem's thin top.
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(0), NodeId(3), NodeId(4)},
                     {{0, 0, 0}, {0, 0, 1}, {0, 0, 4}, {3, 0, 0}, {3, 0, 3}, {-3, 0, 3}},
                     {0.2f, 0.03f, 0.03f, 0.2f, 0.2f, 0.2f});
    const GraftResult r = graft_branches(s, kDepth, SectionEnd::closed, {});
    expect_sound(s, r);
    EXPECT_EQ(r.report.truncated, 1u);
    for (const NodeId n : nodes(r.tubes)) {
        if (r.tubes.radius(n) != 0.2f || r.tubes.is_root(n)) continue;
        EXPECT_EQ(r.tubes.radius(r.tubes.parent(n)), 0.2f) << "a thick section begins at a thin one";
    }
}

TEST(GraftBranches, TwigThatEndsInsideABranchIsCut) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(2), NodeId(3)},
                     {{0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, 0, 2}, {0, 0, 2}},
                     {0.3f, 0.3f, 0.3f, 0.05f, 0.05f});
    const GraftResult r = graft_branches(s, kDepth, SectionEnd::closed, {});
    expect_sound(s, r);
    EXPECT_EQ(r.report.truncated, 1u);
    EXPECT_EQ(r.report.grafted, 0u);
    EXPECT_EQ(r.report.nodes_inside, 1u);
}

TEST(GraftBranches, TreesWithoutDeepOverlapsAreUnchanged) {
    for (const Skeleton& s : {loop(0.13f), loop(1), Skeleton({NodeId::none()}, {{}}, {1})}) {
        const GraftResult r = graft_branches(s, kDepth, SectionEnd::closed, {});
        EXPECT_EQ(r.report.truncated, 0u);
        EXPECT_EQ(r.report.grafted, 0u);
        EXPECT_TRUE(std::ranges::equal(r.tubes.parents(), s.parents()));
        expect_sound(s, r);
    }
    const Skeleton tree = random_tree(3000, 2);
    const GraftResult r = graft_branches(tree, kDepth, SectionEnd::closed, {});
    EXPECT_LT(r.report.grafted, 30u);
    expect_sound(tree, r);
}

TEST(GraftBranches, DepthZeroChangesNothing) {
    const Skeleton s = loop(0);
    const GraftResult r = graft_branches(s, 0, SectionEnd::closed, {});
    EXPECT_TRUE(std::ranges::equal(r.tubes.positions(), s.positions()));
    EXPECT_TRUE(std::ranges::equal(r.tubes.parents(), s.parents()));
}

TEST(GraftBranches, BranchesOfTwoTreesAreGrafted) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId::none(), NodeId(2)},
                     {{0, 0, 0}, {0, 0, 4}, {-2, 0, 2}, {2, 0, 2}}, {0.1f, 0.1f, 0.05f, 0.05f});
    const GraftResult r = graft_branches(s, kDepth, SectionEnd::closed, {});
    EXPECT_EQ(r.report.truncated, 1u);
    EXPECT_EQ(r.report.grafted, 1u);
    EXPECT_EQ(r.tubes.tree_count(), 2u);
    const std::vector<NodeId> root = tree_roots(r.tubes);
    for (const NodeId n : nodes(r.tubes)) {
        const bool beyond = r.tubes.position(n).x > 0.01f;  // of the stem: the section that it now carries
        EXPECT_EQ(r.tubes.position(root[n.index()]) == (Vec3{0, 0, 0}),
                  beyond || std::abs(r.tubes.position(n).x) < 0.01f);
    }
}

TEST(GraftBranches, TreeWithItsRootInAnotherTreeIsGrafted) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId::none(), NodeId(2)},
                     {{0, 0, 0}, {0, 0, 4}, {0.02f, 0, 2}, {2, 0, 3}}, {0.1f, 0.1f, 0.05f, 0.05f});
    const GraftResult r = graft_branches(s, kDepth, SectionEnd::closed, {});
    EXPECT_EQ(r.tubes.tree_count(), 1u);
    EXPECT_EQ(r.report.grafted, 1u);
    for (const NodeId n : nodes(r.skeleton)) {
        if (r.skeleton.is_root(n) && r.skeleton.position(n).x > 0) {
            EXPECT_FALSE(r.tube[n.index()]);  // its root has no tube
        }
    }
}

TEST(GraftBranches, EverySkeletonOfTheZooHasASoundResult) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        expect_sound(skeleton, graft_branches(skeleton, kDepth, SectionEnd::closed, {}));
    }
}

TEST(GraftBranches, TangledSegmentsTerminateWithASoundResult) {
    // Every second node of a zigzag returns to nearly the same two positions, so that all segments cross.
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    constexpr std::uint32_t kNodes = 2000;
    for (std::uint32_t i = 0; i < kNodes; ++i) {
        parent.push_back(i == 0 ? NodeId::none() : NodeId(i - 1));
        position.push_back({i % 2 == 0 ? -10.0f : 10.0f, 0, 1e-4f * static_cast<float>(i)});
    }
    const Skeleton s(parent, position, std::vector<float>(kNodes, 0.5f));
    expect_sound(s, graft_branches(s, kDepth, SectionEnd::closed, {}));
}

TEST(GraftBranches, IsBitIdenticalForAnyNumberOfThreads) {
    const Skeleton s = loop(0.02f);
    Context one, seven;
    one.threads = 1;
    seven.threads = 7;
    const GraftResult a = graft_branches(s, kDepth, SectionEnd::closed, one),
                      b = graft_branches(s, kDepth, SectionEnd::closed, seven);
    EXPECT_TRUE(std::ranges::equal(a.tubes.positions(), b.tubes.positions()));
    EXPECT_EQ(a.tube, b.tube);
}

}  // namespace
}  // namespace coppice
