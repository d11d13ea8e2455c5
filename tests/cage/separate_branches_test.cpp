#include "coppice/cage/separate_branches.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "coppice/base/random.h"
#include "zoo.h"

namespace coppice {
namespace {

// A stem along z with a lateral that leaves node 1 at an angle; the stem continues over several nodes.
Skeleton stem_with_lateral(float degrees) {
    const float a = degrees * 3.14159265f / 180;
    const Vec3 d{std::sin(a), 0, std::cos(a)};
    return {{NodeId::none(), NodeId(0), NodeId(1), NodeId(2), NodeId(1), NodeId(4), NodeId(5)},
            {{0, 0, 0},
             {0, 0, 1},
             {0, 0, 1.4f},
             {0, 0, 2.8f},
             Vec3{0, 0, 1} + d * 0.5f,
             Vec3{0, 0, 1} + d * 1.2f,
             Vec3{0, 0, 1} + d * 2.2f},
            {0.2f, 0.2f, 0.2f, 0.1f, 0.08f, 0.08f, 0.05f}};
}

TEST(PartBranches, WideForkIsUnchanged) {
    const Skeleton s = stem_with_lateral(80);
    const SeparatedSkeleton r = separate_branches(s, {}, {});
    EXPECT_EQ(r.skeleton.size(), s.size());
    EXPECT_EQ(r.report.merged_nodes + r.report.shifted_nodes + r.report.paired_nodes + r.report.hidden_tips,
              0u);
}

TEST(PartBranches, MovesTheForkOfAnAcuteLateralTowardsItsCrotch) {
    const Skeleton s = stem_with_lateral(15);
    const SeparatedSkeleton r = separate_branches(s, {}, {});
    // (0.2 + 0.08 cos 15) / tan 15 is where the tubes separate: more than a length unit above the node.
    float highest = 0;
    for (const NodeId n : nodes(r.skeleton)) {
        if (r.skeleton.children(n).size() > 1) highest = std::max(highest, r.skeleton.position(n).z);
    }
    EXPECT_GT(highest, 1.3f);
}

TEST(PartBranches, TipInsideAnotherBranchIsHidden) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 1}, {0, 0, 3}, {0.1f, 0, 1}}, {0.5f, 0.5f, 0.5f, 0.05f});
    EXPECT_EQ(separate_branches(s, {}, {}).report.hidden_tips, 1u);
}

TEST(PartBranches, StemsInOppositeDirectionsAreUnchanged) {
    // With equal radii they separate at the ball around their node; the quotient for the crotch is 0 / 0
    // there.
    const Skeleton s = zoo_skeleton("opposite_stems");
    const SeparatedSkeleton r = separate_branches(s, {}, {});
    EXPECT_EQ(r.report.merged_nodes + r.report.shifted_nodes + r.report.paired_nodes + r.report.hidden_tips,
              0u);
    EXPECT_EQ(r.skeleton.children(NodeId(0)).size(), 2u);
}

/// A random tree of chains and acute forks, `far` away from zero, with radii of about 1.
Skeleton random_chains(std::uint64_t seed, float far) {
    const CounterRandom random(seed, 0);
    std::uint64_t drawn = 0;
    const auto next = [&] { return static_cast<float>(random.uniform(drawn++)); };
    std::vector<NodeId> parent{NodeId::none()};
    std::vector<Vec3> position{{far, far, far}};
    std::vector<float> radius{1};
    for (std::uint32_t i = 1; i < 40; ++i) {
        const bool goes_on = next() < 0.75f;
        const auto from = goes_on ? i - 1 : static_cast<std::uint32_t>(next() * static_cast<float>(i));
        parent.emplace_back(from);
        position.push_back(position[from] +
                           Vec3{next() - 0.5f, next() - 0.5f, next() - 0.2f} * (8 * next() * radius[from]));
        radius.push_back(radius[from] * (0.6f + 0.4f * next()));
    }
    return {std::move(parent), std::move(position), std::move(radius)};
}

// At 1e8 floats are 8 apart: nodes cannot be moved by less.
TEST(PartBranches, TerminatesWherePositionsExceedFloatPrecision) {
    for (const float far : {0.0f, 1e6f, 1e7f, 1e8f, 1e9f}) {
        for (std::uint64_t seed = 1; seed <= 200; ++seed) {
            const Skeleton s = random_chains(seed, far);
            const SeparatedSkeleton r = separate_branches(s, {}, {});
            EXPECT_EQ(r.tube.size(), s.size());
        }
    }
}

TEST(PartBranches, ScalesExactlyByPowersOfTwo) {
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        const Skeleton s = random_chains(seed, 0);
        const SeparatedSkeleton one = separate_branches(s, {}, {});
        for (const int power : {-30, -7, 7, 30}) {
            std::vector<Vec3> position(s.positions().begin(), s.positions().end());
            std::vector<float> radius(s.radii().begin(), s.radii().end());
            const float factor = std::ldexp(1.0f, power);
            for (Vec3& p : position) p = p * factor;
            for (float& r : radius) r *= factor;
            const SeparatedSkeleton other =
                separate_branches({{s.parents().begin(), s.parents().end()}, position, radius}, {}, {});
            ASSERT_EQ(other.source, one.source) << seed;
            for (const NodeId n : nodes(one.skeleton)) {
                EXPECT_EQ(other.skeleton.parent(n), one.skeleton.parent(n));
                EXPECT_EQ(other.skeleton.position(n), one.skeleton.position(n) * factor);
                EXPECT_EQ(other.skeleton.radius(n), one.skeleton.radius(n) * factor);
            }
        }
    }
}

TEST(PartBranches, EveryNodeHasATubeAndEverySourceIsANode) {
    for (const auto& [name, s] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const SeparatedSkeleton r = separate_branches(s, {}, {});
        ASSERT_EQ(r.tube.size(), s.size());
        ASSERT_EQ(r.source.size(), r.skeleton.size());
        for (const NodeId t : r.tube) ASSERT_LT(t.index(), r.skeleton.size());
        for (const NodeId n : r.source) ASSERT_LT(n.index(), s.size());
    }
}

TEST(PartBranches, PreservesAllTipsButHiddenOnes) {
    for (const auto& [name, s] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const SeparatedSkeleton r = separate_branches(s, {}, {});
        std::set<std::uint32_t> kept;
        for (const NodeId n : nodes(r.skeleton)) {
            if (r.skeleton.is_tip(n)) kept.insert(r.source[n.index()].index());
        }
        std::uint32_t lost = 0;
        for (const NodeId n : nodes(s)) lost += s.is_tip(n) && !kept.contains(n.index());
        EXPECT_EQ(lost, r.report.hidden_tips);
    }
}

TEST(PartBranches, NodesAreInDepthFirstOrder) {
    for (const auto& [name, s] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const Skeleton parted = separate_branches(s, {}, {}).skeleton;
        std::vector<NodeId> open;
        for (const NodeId n : nodes(parted)) {
            while (!open.empty() && open.back() != parted.parent(n)) open.pop_back();
            ASSERT_TRUE(parted.is_root(n) || !open.empty());
            open.push_back(n);
        }
    }
}

}  // namespace
}  // namespace coppice
