#include "coppice/skeleton/resample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "coppice/base/hash.h"
#include "coppice/skeleton/measure.h"
#include "coppice/skeleton/segment_cone.h"
#include "zoo.h"

namespace coppice {
namespace {

struct Ball {
    Vec3 position;
    float radius;
};

Skeleton chain(const std::vector<Ball>& balls) {
    std::vector<NodeId> parents;
    std::vector<Vec3> positions;
    std::vector<float> radii;
    for (const Ball& b : balls) {
        parents.push_back(parents.empty() ? NodeId::none()
                                          : NodeId(static_cast<std::uint32_t>(parents.size() - 1)));
        positions.push_back(b.position);
        radii.push_back(b.radius);
    }
    return Skeleton(parents, positions, radii);
}

/// Returns the minimum distance of the ball (p, r) to any segment, in position and radius, relative to r.
double deviation(const Skeleton& s, Vec3 p, float r) {
    double best = 1e300;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const Segment g = s.segment(n);
        for (int i = 0; i <= 400; ++i) {
            const float t = static_cast<float>(i) / 400;
            const double dr = g.radius_a + t * (g.radius_b - g.radius_a) - r;
            best = std::min(best, std::hypot(distance(lerp(g.a, g.b, t), p), dr));
        }
    }
    return best / r;
}

TEST(Resample, NoneChangesNothing) {
    const Skeleton s = zoo_skeleton("helix");
    EXPECT_EQ(resample(s, {.method = ResampleMethod::none}).skeleton.size(), s.size());
}

TEST(Resample, RemovesNodesOfAStraightTaperAndPreservesKinks) {
    // The radius decreases linearly except for the kink at z = 20.
    const Skeleton s = chain(
        {{{0, 0, 0}, 2}, {{0, 0, 10}, 1.75f}, {{0, 0, 20}, 1.5f}, {{0, 0, 30}, 1.5f}, {{0, 0, 35}, 1.5f}});
    const ResampleResult r = resample(s, {.max_length = 100});
    ASSERT_EQ(r.skeleton.size(), 3u);
    EXPECT_EQ(r.report.removed, 2u);
    EXPECT_EQ(r.skeleton.position(NodeId(1)), Vec3(0, 0, 20));
    EXPECT_EQ(r.new_of_old[1], NodeId(1));  // the next kept one towards the tip
    EXPECT_EQ(r.new_of_old[3], NodeId(2));
}

TEST(Resample, DeviationIsWithinTheTolerance) {
    std::vector<Ball> wave;
    for (int i = 0; i <= 200; ++i) {
        const float x = 0.3f * static_cast<float>(i);
        wave.push_back({{x, 2 * std::sin(0.3f * x), 0}, 0.3f + 0.05f * std::sin(0.7f * x)});
    }
    const Skeleton s = chain(wave);
    for (const float tolerance : {0.02f, 0.2f}) {
        const ResampleResult r = resample(s, {.tolerance = tolerance, .min_spacing = 0});
        EXPECT_GT(r.report.removed, 50u);
        for (const Ball& b : wave) EXPECT_LE(deviation(r.skeleton, b.position, b.radius), tolerance + 0.005);
    }
}

TEST(Resample, NodesRespectTheMinimumSpacing) {
    std::vector<Ball> dense;
    for (int i = 0; i <= 300; ++i) {
        const float t = 0.05f * static_cast<float>(i);
        dense.push_back({{3 * std::cos(t), 3 * std::sin(t), t}, 1 + 0.1f * static_cast<float>(i % 2)});
    }
    const ResampleResult r = resample(chain(dense));
    for (const NodeId n : nodes(r.skeleton)) {
        if (r.skeleton.is_root(n)) continue;
        const Segment g = r.skeleton.segment(n);
        EXPECT_GE(distance(g.a, g.b), 0.9f * std::min(g.radius_a, g.radius_b) * 0.999f);
    }
}

TEST(Resample, SeparatesTheEndsOfARadiusJump) {
    const ResampleResult r = resample(zoo_skeleton("radius_jump"), {.max_length = 1000});
    ASSERT_EQ(r.skeleton.size(), 4u);
    EXPECT_GT(r.report.moved, 0u);
    const Segment jump = r.skeleton.segment(NodeId(2));
    EXPECT_FLOAT_EQ(jump.radius_a, 0.5f);
    EXPECT_FLOAT_EQ(jump.radius_b, 13);
    EXPECT_NEAR(distance(jump.a, jump.b), 0.9 * 0.5, 1e-4);
}

TEST(Resample, SplitsLongSegmentsEvenly) {
    // 100 long with radius 1, at most 20 radii: five sections, and a ring before the tip.
    const ResampleResult r = resample(chain({{{0, 0, 0}, 1}, {{0, 0, 100}, 1}}));
    ASSERT_EQ(r.skeleton.size(), 7u);
    EXPECT_EQ(r.report.inserted, 5u);
    EXPECT_FLOAT_EQ(r.skeleton.position(NodeId(2)).z, 0.4f * 98.5f);
    EXPECT_FLOAT_EQ(r.skeleton.position(NodeId(5)).z, 98.5f);
}

TEST(Resample, SplitsTapersByLocalRadii) {
    const ResampleResult r = resample(chain({{{0, 0, 0}, 1}, {{0, 0, 50}, 0.1f}}));
    // ln 10 / 0.9 times 50 radii, minus the ring before the tip.
    ASSERT_GE(r.skeleton.size(), 7u);
    std::vector<double> lengths;
    for (const NodeId n : nodes(r.skeleton)) {
        if (r.skeleton.is_root(n) || r.skeleton.is_tip(n)) continue;
        const Segment g = r.skeleton.segment(n);
        EXPECT_NEAR(g.radius_b, 1 - 0.9 * g.b.z / 50, 1e-5);
        lengths.push_back(distance(g.a, g.b) / std::sqrt(g.radius_a * g.radius_b));
    }
    for (const double l : lengths) EXPECT_NEAR(l, lengths.front(), 0.02 * l);
    EXPECT_LT(lengths.front(), 21);
}

TEST(Resample, AddsARingBeforeATipOfALongSegment) {
    const auto with_tip_at = [](float x) {
        return resample(chain({{{0, 0, 0}, 1}, {{0, 0, 5}, 1}, {{x, 0, 5}, 1}}), {.bend_angle = 3}).skeleton;
    };
    EXPECT_EQ(with_tip_at(11.9f).size(), 3u);
    ASSERT_EQ(with_tip_at(12.1f).size(), 4u);
    EXPECT_FLOAT_EQ(with_tip_at(12.1f).position(NodeId(2)).x, 10.6f);
    // Half of a single segment counts, which then has a node in the middle of the rest.
    EXPECT_EQ(resample(chain({{{0, 0, 0}, 1}, {{0, 0, 19.9f}, 1}})).skeleton.size(), 2u);
    const Skeleton lone = resample(chain({{{0, 0, 0}, 1}, {{0, 0, 24.5f}, 1}})).skeleton;
    ASSERT_EQ(lone.size(), 4u);
    EXPECT_FLOAT_EQ(lone.position(NodeId(1)).z, 11.5f);
    EXPECT_FLOAT_EQ(lone.position(NodeId(2)).z, 23);
}

TEST(Resample, AddsRingsWhereBranchesLeaveABall) {
    const Skeleton soma({NodeId::none(), NodeId(0), NodeId(0)}, {{0, 0, 0}, {0, 0, 5}, {30, 0, 0}},
                        {2, 0.5f, 0.4f});
    ASSERT_TRUE(is_ball(soma, NodeId(0)));
    const ResampleResult r = resample(soma);
    const NodeId leader = r.skeleton.leader(NodeId(0));
    EXPECT_FLOAT_EQ(r.skeleton.position(leader).z, 2.1f);
    // On the common tangent of the balls at the root and at the leader's end; its sine is 0.3.
    EXPECT_NEAR(r.skeleton.radius(leader), (2 - 2.1 * 0.3) / std::sqrt(1 - 0.09), 1e-5);
    const auto lateral = std::ranges::find_if(r.skeleton.children(NodeId(0)),
                                              [&](NodeId c) { return r.skeleton.position(c).x > 1; });
    ASSERT_NE(lateral, r.skeleton.children(NodeId(0)).end());
    EXPECT_FLOAT_EQ(r.skeleton.position(*lateral).x, 2.1f);
    EXPECT_FLOAT_EQ(r.skeleton.radius(*lateral), 0.4f);
}

TEST(Resample, AddsRingsNextToASharpTurn) {
    const ResampleResult r = resample(zoo_skeleton("right_angle_bend"));
    ASSERT_EQ(r.skeleton.size(), 5u);
    EXPECT_FLOAT_EQ(r.skeleton.position(NodeId(1)).z, 3.5f);
    EXPECT_FLOAT_EQ(r.skeleton.position(NodeId(3)).x, 1.5f);
}

TEST(Resample, InsertionIsLimitedOnThinThreads) {
    const ResampleResult r = resample(chain({{{0, 0, 0}, 1e-12f}, {{0, 0, 1e15f}, 1e-12f}}));
    EXPECT_LE(r.skeleton.size(), 20'000u);
}

TEST(Resample, ZhuRemovesStraightAndShortSegments) {
    const float a = 0.05f;  // less than zhu_angle
    const Skeleton s = chain({{{0, 0, 0}, 1},
                              {{0, 0, 5}, 1},
                              {{5 * std::sin(a), 0, 10}, 1},
                              {{5, 0, 10}, 1},
                              {{5.5f, 0, 10.5f}, 1},
                              {{5, 0, 15}, 1}});
    const ResampleResult r = resample(s, {.method = ResampleMethod::zhu});
    // 1 turns by 0.05; 2 turns by 90 degrees and is kept; 3 is 0.7 from 4; 4, seen from 2, turns and is kept.
    EXPECT_EQ(r.report.removed, 2u);
    EXPECT_EQ(r.skeleton.position(NodeId(1)), s.position(NodeId(2)));
    EXPECT_EQ(r.skeleton.position(NodeId(2)), s.position(NodeId(4)));
}

TEST(Resample, PreservesRootsForksAndTips) {
    for (const auto& [name, s] : skeleton_zoo()) {
        for (const auto method : {ResampleMethod::zhu, ResampleMethod::simplify}) {
            SCOPED_TRACE(name + " " + std::string(name_of(method)));
            const ResampleResult r = resample(s, {.method = method});
            const SkeletonMeasures before = measure(s), after = measure(r.skeleton);
            EXPECT_EQ(before.trees, after.trees);
            EXPECT_EQ(before.tips, after.tips);
            EXPECT_EQ(before.branch_nodes, after.branch_nodes);
            EXPECT_EQ(before.max_children, after.max_children);
            EXPECT_EQ(r.skeleton.size(), s.size() - r.report.removed + r.report.inserted);
            EXPECT_NEAR(after.length, before.length, 0.1 * before.length + 3 * before.max_radius);
            for (const NodeId n : nodes(s)) {
                const bool anchor = s.is_root(n) || s.children(n).size() != 1;
                if (!anchor) continue;
                EXPECT_EQ(r.skeleton.position(r.new_of_old[n.index()]), s.position(n));
            }
        }
    }
}

TEST(Resample, PreservesTheLeader) {
    for (const auto& [name, s] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const ResampleResult r = resample(s);
        for (const NodeId n : nodes(s)) {
            if (s.children(n).size() < 2) continue;
            // The new leader is an ancestor of the image of the old one, or that image itself.
            const NodeId node = r.new_of_old[n.index()], leader = r.skeleton.leader(node);
            NodeId image = r.new_of_old[s.leader(n).index()];
            while (image != leader && image > node) image = r.skeleton.parent(image);
            EXPECT_EQ(image, leader) << "node " << n.index();
        }
    }
}

TEST(Resample, TaperingLeaderPreservesItsFirstNode) {
    // The leader decreases linearly from 1 to 0.1; without its first node the sibling of 0.5 would lead.
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(2), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 4}, {0, 0, 8}, {0, 0, 12}, {5, 0, 4}}, {1, 1, 0.55f, 0.1f, 0.5f});
    const ResampleResult r = resample(s);
    EXPECT_EQ(r.skeleton.position(r.skeleton.leader(r.new_of_old[1])), Vec3(0, 0, 8));
}

TEST(Resample, AcceptsAMillionNodesOfOneChain) {
    std::vector<Ball> balls;
    for (int i = 0; i < 1'000'000; ++i) {
        // Increasingly far from the chord: the split is always near one end.
        const auto x = static_cast<float>(i);
        balls.push_back({{std::sqrt(x), 0.001f * x, i % 7 == 0 ? 0.5f : 0.0f}, 0.001f});
    }
    const ResampleResult r = resample(chain(balls));
    EXPECT_GT(r.skeleton.size(), 1000u);
}

}  // namespace
}  // namespace coppice
