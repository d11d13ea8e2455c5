#include "coppice/measure/match/skeleton_match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "coppice/measure/capsule_tree.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/skeleton/resample.h"
#include "measure/support.h"
#include "zoo.h"

namespace coppice {
namespace {

/// One segment of ten metres along z, radius 0.5.
Skeleton pole(float radius = 0.5f, Vec3 shift = {}, Vec3d origin = {}) {
    return Skeleton({kRoot, NodeId(0)}, {shift, Vec3{0, 0, 10} + shift}, {radius, radius}, origin);
}

/// A T: trunk to (0, 0, 4), leader to (0, 0, 8), lateral to (5, 0, 4).
Skeleton fork(float leader_end = 8) {
    return Skeleton({kRoot, NodeId(0), NodeId(1), NodeId(1)},
                    {{0, 0, 0}, {0, 0, 4}, {0, 0, leader_end}, {5, 0, 4}}, {0.5f, 0.5f, 0.5f, 0.25f});
}

Skeleton moved(const Skeleton& s, Vec3d by) {
    return Skeleton({s.parents().begin(), s.parents().end()}, {s.positions().begin(), s.positions().end()},
                    {s.radii().begin(), s.radii().end()}, s.origin() + by);
}

Skeleton with_radii_times(const Skeleton& s, float factor) {
    std::vector<float> radii(s.radii().begin(), s.radii().end());
    for (float& r : radii) r *= factor;
    return Skeleton({s.parents().begin(), s.parents().end()}, {s.positions().begin(), s.positions().end()},
                    std::move(radii), s.origin());
}

/// The same axis in the other direction, from the far end of a chain.
Skeleton reversed_pole() { return Skeleton({kRoot, NodeId(0)}, {{0, 0, 10}, {0, 0, 0}}, {0.5f, 0.5f}); }

void expect_perfect(const SkeletonMatch& m) {
    EXPECT_NEAR(m.covered_percent, 100, 1e-9);
    EXPECT_NEAR(m.true_percent, 100, 1e-9);
    EXPECT_EQ(m.tips.percent(), 100);
    EXPECT_EQ(m.tips.spurious(), 0u);
    EXPECT_EQ(m.junctions.percent(), 100);
    EXPECT_EQ(m.junctions.spurious(), 0u);
    EXPECT_EQ(m.tips_reached, 100);
}

/// Spokes of one metre from one node, evenly distributed over the sphere.
Skeleton star(std::uint32_t spokes) {
    std::vector<NodeId> parents{kRoot};
    std::vector<Vec3> positions{{}};
    for (std::uint32_t i = 0; i < spokes; ++i) {
        const double z = 1 - (2 * i + 1.0) / spokes, turn = 2.399963 * i, around = std::sqrt(1 - z * z);
        parents.emplace_back(0);
        positions.push_back(Vec3(Vec3d{around * std::cos(turn), around * std::sin(turn), z}));
    }
    return Skeleton(parents, positions, std::vector<float>(positions.size(), 0.01f));
}

// The boxes of the spokes overlap, so that each of the 200,000 samples would visit an eighth of them: a
// minute of computing.
TEST(SkeletonMatch, OfAStarWithItselfIsPerfect) {
    const Skeleton s = star(5'000);
    const SkeletonMatch m = compare(s, s, {.step = 100});
    EXPECT_NEAR(m.covered_percent, 100, 1e-9);
    EXPECT_NEAR(m.true_percent, 100, 1e-9);
    EXPECT_NEAR(m.off_axis, 0, 1e-6);
}

TEST(SkeletonMatch, OfASkeletonWithItselfIsPerfect) {
    for (const auto& [name, s] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const SkeletonMatch m = compare(s, s);
        EXPECT_EQ(m.length.ratio(), m.length.reference > 0 ? 1 : 0);
        if (m.length.reference == 0) continue;
        expect_perfect(m);
        EXPECT_EQ(m.reference_nodes_m.n, s.size());
        EXPECT_NEAR(m.off_axis, 0, 1e-6);
        EXPECT_NEAR(m.radius_error.p50, 0, 1e-6);
    }
    const Skeleton tree = random_tree(3000, 1);
    const SkeletonMatch m = compare(tree, tree);
    expect_perfect(m);
    EXPECT_EQ(m.volume.ratio(), 1);
    EXPECT_NEAR(m.radius_error.max, 0, 1e-5);
    EXPECT_NEAR(m.reference_nodes_m.max, 0, 1e-9);
    EXPECT_NEAR(m.found_nodes_r.max, 0, 1e-6);
}

TEST(SkeletonMatch, ShiftByHalfARadiusIsMatched) {
    const SkeletonMatch m = compare(pole(), pole(0.5f, {0.25f, 0, 0}));
    expect_perfect(m);
    EXPECT_NEAR(m.off_axis, 0.5, 1e-9);
    for (const Statistics& s : {m.reference_nodes_m, m.found_nodes_m}) EXPECT_NEAR(s.p50, 0.25, 1e-7);
    for (const Statistics& s : {m.reference_nodes_r, m.found_nodes_r}) EXPECT_NEAR(s.p95, 0.5, 1e-7);
    EXPECT_EQ(m.radius_error.max, 0);
    EXPECT_EQ(compare(pole(), pole(0.5f, {0.6f, 0, 0})).covered_percent, 0) << "0.6 m are 1.2 radii";
}

TEST(SkeletonMatch, DistancesAreRelativeToRadiiOfTheReference) {
    // 0.4 m apart: within one radius of the thick one, but not of the thin one.
    const Skeleton thick = pole(0.5f), thin = pole(0.25f, {0.4f, 0, 0});
    EXPECT_EQ(compare(thick, thin).covered_percent, 100);
    EXPECT_EQ(compare(thick, thin).true_percent, 100);
    EXPECT_EQ(compare(thin, thick).covered_percent, 0);
    EXPECT_EQ(compare(thin, thick).true_percent, 0);
    EXPECT_NEAR(compare(thick, thin).off_axis, 0.8, 1e-6);
    EXPECT_NEAR(compare(thin, thick).off_axis, 1.6, 1e-6);
}

TEST(SkeletonMatch, ReportsRadiusErrors) {
    const SkeletonMatch m = compare(fork(), with_radii_times(fork(), 0.9f));
    expect_perfect(m);
    EXPECT_NEAR(m.radius_error.min, 0.1, 1e-6);
    EXPECT_NEAR(m.radius_error.max, 0.1, 1e-6);
    EXPECT_NEAR(m.radius_bias, -0.1, 1e-6);
    EXPECT_NEAR(m.volume.ratio(), 0.81, 1e-6);
    EXPECT_NEAR(m.length.ratio(), 1, 1e-12);
}

TEST(SkeletonMatch, LateralsAreNotComparedWithTheirParentBranch) {
    // Where the lateral is 0.1 off its true position, the trunk's axis is nearer to its first section.
    const Skeleton found({kRoot, NodeId(0), NodeId(1), NodeId(1)},
                         {{0, 0, 0}, {0, 0, 4}, {0, 0, 8}, {5, 0, 4.1f}}, {0.5f, 0.5f, 0.5f, 0.25f});
    EXPECT_EQ(compare(fork(), found).radius_error.max, 0);
}

TEST(SkeletonMatch, ReportsAMissingBranch) {
    const Skeleton trunk({kRoot, NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 4}, {0, 0, 8}},
                         {0.5f, 0.5f, 0.5f});
    const SkeletonMatch m = compare(fork(), trunk);
    EXPECT_NEAR(m.length.ratio(), 8.0 / 13, 1e-9);
    // The trunk covers its 8 m and the lateral's first quarter metre, which is within one of its radii.
    EXPECT_NEAR(m.covered_percent, 100 * 8.25 / 13, 0.5);
    EXPECT_EQ(m.true_percent, 100);
    EXPECT_EQ(m.tips.reference, 2u);
    EXPECT_EQ(m.tips.found, 1u);
    EXPECT_EQ(m.tips.matched, 1u);
    EXPECT_EQ(m.tips.missed(), 1u);
    EXPECT_EQ(m.tips_reached, 50);
    EXPECT_EQ(m.junctions.percent(), 0);
    const SkeletonMatch back = compare(trunk, fork());
    EXPECT_EQ(back.covered_percent, 100);
    EXPECT_NEAR(back.true_percent, 100 * 8.5 / 13, 0.5) << "half a metre of the lateral is inside the trunk";
    EXPECT_EQ(back.tips.spurious(), 1u);
    EXPECT_EQ(back.junctions.percent(), 100) << "the reference has no junctions";
    EXPECT_EQ(back.junctions.spurious(), 1u);
}

TEST(SkeletonMatch, ReportsAShortenedBranch) {
    // The leader ends 0.9, then 1.1 metres early: 1.8 and 2.2 radii.
    const SkeletonMatch near = compare(fork(), fork(7.1f)), far = compare(fork(), fork(6.9f));
    EXPECT_EQ(near.tips.matched, 2u);
    EXPECT_EQ(far.tips.matched, 1u);
    EXPECT_EQ(far.tips_reached, 50);
    EXPECT_EQ(far.tips.spurious(), 1u);
    EXPECT_NEAR(far.covered_percent, 100 * (13 - 0.6) / 13, 1) << "0.5 m of 1.1 are within one radius";
    // If it has grown longer instead, the axis still passes the true tip.
    EXPECT_EQ(compare(fork(), fork(9.5f)).tips.matched, 1u);
    EXPECT_EQ(compare(fork(), fork(9.5f)).tips_reached, 100);
}

TEST(SkeletonMatch, IsIndependentOfNodesAndRoots) {
    const Skeleton tree = random_tree(300, 2);
    const Skeleton denser = resample(tree, {.tolerance = 0, .min_spacing = 0, .max_length = 1}).skeleton;
    ASSERT_GT(denser.size(), 2 * tree.size());
    const SkeletonMatch m = compare(tree, denser);
    expect_perfect(m);
    EXPECT_NEAR(m.length.ratio(), 1, 1e-6);
    EXPECT_NEAR(m.radius_error.p95, 0, 1e-3);
    const SkeletonMatch turned = compare(pole(), reversed_pole());
    expect_perfect(turned);
    EXPECT_EQ(turned.tips.found, 1u);
}

TEST(SkeletonMatch, ConvertsOrigins) {
    expect_perfect(compare(fork(), moved(moved(fork(), {1e6, -2e6, 50}), {-1e6, 2e6, -50})));
    const Skeleton local({kRoot, NodeId(0)}, {{-100, 0, 0}, {-100, 0, 10}}, {0.5f, 0.5f}, {100, 0, 0});
    expect_perfect(compare(pole(), local));
    EXPECT_EQ(compare(pole(), moved(pole(), {100, 0, 0})).covered_percent, 0);
}

TEST(SkeletonMatch, DistantSkeletonsDoNotMatch) {
    const SkeletonMatch m = compare(fork(), moved(fork(), {1000, 0, 0}));
    EXPECT_EQ(m.covered_percent, 0);
    EXPECT_EQ(m.true_percent, 0);
    EXPECT_EQ(m.tips.matched, 0u);
    EXPECT_EQ(m.tips.spurious(), 2u);
    EXPECT_EQ(m.radius_error.n, 0u);
    EXPECT_NEAR(m.reference_nodes_m.p50, 1000, 6);
}

TEST(SkeletonMatch, SingleNodesHaveNoAxis) {
    const Skeleton dot({kRoot}, {{0, 0, 0}}, {1}), dots({kRoot, kRoot}, {{0, 0, 0}, {0, 0, 9}}, {1, 1});
    const SkeletonMatch m = compare(dot, dots);
    EXPECT_EQ(m.length.ratio(), 0);
    EXPECT_EQ(m.covered_percent, 0);
    EXPECT_EQ(m.reference_nodes_m.n, 0u);
    EXPECT_EQ(m.tips.reference, 0u);
    const SkeletonMatch known = compare(pole(), dots);
    EXPECT_EQ(known.covered_percent, 0);
    EXPECT_EQ(known.tips.missed(), 1u);
    EXPECT_EQ(known.found_nodes_m.n, 2u);
    EXPECT_EQ(compare(dots, pole()).reference_nodes_m.n, 2u);
}

TEST(SkeletonMatch, SegmentsOfLengthZeroHaveNoWeight) {
    const Skeleton s({kRoot, NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 0}, {0, 0, 10}}, {0.5f, 0.5f, 0.5f});
    expect_perfect(compare(pole(), s));
    const Skeleton none({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 0}}, {0.5f, 0.5f});
    EXPECT_EQ(compare(none, pole()).covered_percent, 0);
    EXPECT_EQ(compare(pole(), none).true_percent, 0);
}

TEST(SkeletonMatch, LongThinSegmentsAreSampledCoarsely) {
    const Skeleton thread({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 1e4f}}, {1e-6f, 1e-6f});
    EXPECT_NEAR(compare(thread, pole()).covered_percent, 0.1, 0.01) << "10 m of 10 km";
    EXPECT_LE(compare(thread, thread).radius_error.n, 64u + 65536u + 1u);
}

TEST(SkeletonMatch, SamplesOfAStarAreProportionalToItsSpokes) {
    const Skeleton few = star(100),
                   many = star(2000);  // spokes of 100 radii: 400 samples are requested for each
    const auto n = static_cast<double>(compare(few, few).radius_error.n);
    EXPECT_NEAR(n, 100 * 400, 100) << "up to one additional sample for each, because numbers are rounded up";
    EXPECT_LE(compare(many, many).radius_error.n, 2000 * (64u + 1u) + 65536u);
}

TEST(SkeletonMatch, LongSegmentDoesNotReduceTheSamplesOfOthers) {
    // The pole requests 10 / (0.25 0.5) = 80 samples; the segment to a point 6000 km away gets all the rest.
    const Skeleton s({kRoot, NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 10}, {6e6f, 0, 10}},
                     {0.5f, 0.5f, 0.5f});
    EXPECT_EQ(compare(pole(), s).radius_error.n, 80u);
    const std::uint64_t n = compare(s, s).radius_error.n;
    EXPECT_LE(n, 2 * 64u + 65536u + 2u);
    EXPECT_GT(n, 65536u);
}

TEST(SkeletonMatch, IsBitIdenticalForAnyNumberOfThreads) {
    const Skeleton a = random_tree(3000, 1), b = random_tree(3000, 1, true);
    const SkeletonMatch one = compare(a, b, {}, {.threads = 1});
    EXPECT_GT(one.covered_percent, 0);
    EXPECT_EQ(one, compare(a, b, {}, {.threads = 2}));
    EXPECT_EQ(one, compare(a, b, {}, {.threads = 7}));
}

TEST(SkeletonMatch, RejectsInvalidOptions) {
    EXPECT_THROW(compare(pole(), pole(), {.step = 0}), InvalidInput);
    EXPECT_THROW(compare(pole(), pole(), {.within = -1}), InvalidInput);
    EXPECT_THROW(compare(pole(), pole(), {.tip_reach = std::numeric_limits<float>::quiet_NaN()}),
                 InvalidInput);
}

TEST(SkeletonMatch, StopsWhenCancelled) {
    std::stop_source source;
    source.request_stop();
    Context ctx;
    ctx.stop = source.get_token();
    EXPECT_THROW(compare(pole(), pole(), {}, ctx), Cancelled);
}

}  // namespace
}  // namespace coppice
