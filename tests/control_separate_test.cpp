#include "coppice/control/separate.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/base/segment_distance.h"
#include "zoo.h"

namespace coppice {
namespace {

// A stem, a long way round, and a branch that comes back and passes the stem at the given distance.
Skeleton loop(float offset, float radius = 0.1f) {
    return {{NodeId::none(), NodeId(0), NodeId(1), NodeId(2), NodeId(3), NodeId(4)},
            {{0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, offset, 2}, {1, offset, 2}, {-2, offset, 2}},
            {0.1f, 0.1f, 0.1f, radius, radius, radius}};
}

double axis_distance(const Skeleton& s, std::uint32_t a, std::uint32_t b) {
    const auto at = [&](NodeId n) { return Vec3d(s.position(n)); };
    return segment_distance(at(s.parent(NodeId(a))), at(NodeId(a)), at(s.parent(NodeId(b))), at(NodeId(b)));
}

TEST(SeparateCrossings, BendsApartWhatCrosses) {
    for (const float offset : {0.0f, 0.02f, 0.1f}) {
        const SeparateResult r = separate_crossings(loop(offset), 0.6f, {});
        EXPECT_EQ(r.crossings, 1u);
        EXPECT_GT(r.moved, 0u);
        EXPECT_GE(axis_distance(r.skeleton, 1, 5), 0.6 * 0.2) << "offset " << offset;
    }
}

TEST(SeparateCrossings, TheThickBranchStands) {
    const Skeleton before = loop(0.02f, 0.03f);
    const SeparateResult r = separate_crossings(before, 0.6f, {});
    EXPECT_EQ(r.crossings, 1u);
    EXPECT_EQ(r.skeleton.position(NodeId(1)), before.position(NodeId(1)));
}

TEST(SeparateCrossings, LeavesShallowOverlapsAndDistantBranchesAlone) {
    for (const float offset : {0.15f, 0.3f}) {
        const SeparateResult r = separate_crossings(loop(offset), 0.6f, {});
        EXPECT_EQ(r.crossings, 0u);
        EXPECT_EQ(r.moved, 0u);
    }
}

TEST(SeparateCrossings, DepthZeroChangesNothing) { EXPECT_EQ(separate_crossings(loop(0), 0, {}).moved, 0u); }

TEST(SeparateCrossings, TanglesStayAsTheyAre) {
    // Every second node of a zigzag comes back to nearly the same two places, so that all segments cross.
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    constexpr std::uint32_t kNodes = 400;
    for (std::uint32_t i = 0; i < kNodes; ++i) {
        parent.push_back(i == 0 ? NodeId::none() : NodeId(i - 1));
        position.push_back({i % 2 == 0 ? -10.0f : 10.0f, 0, 1e-4f * static_cast<float>(i)});
    }
    const Skeleton s(parent, position, std::vector<float>(kNodes, 0.5f));
    const SeparateResult r = separate_crossings(s, 0.6f, {});
    EXPECT_GT(r.crossings, 4 * kNodes);
    EXPECT_EQ(r.moved, 0u);
}

TEST(SeparateCrossings, RootsStayAndTheZooStaysValid) {
    for (const auto& [name, s] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const Skeleton out = separate_crossings(s, 0.6f, {}).skeleton;
        ASSERT_EQ(out.size(), s.size());
        for (const NodeId n : nodes(s)) {
            EXPECT_TRUE(!s.is_root(n) || out.position(n) == s.position(n));
        }
    }
}

TEST(SeparateCrossings, SameBitsForAnyNumberOfThreads) {
    const Skeleton s = zoo_skeleton("random_large_hard");
    Context one;
    one.threads = 1;
    const Skeleton first = separate_crossings(s, 0.6f, one).skeleton;
    for (const unsigned threads : {2u, 7u}) {
        Context ctx;
        ctx.threads = threads;
        const Skeleton again = separate_crossings(s, 0.6f, ctx).skeleton;
        EXPECT_TRUE(std::ranges::equal(again.positions(), first.positions()));
    }
}

}  // namespace
}  // namespace coppice
