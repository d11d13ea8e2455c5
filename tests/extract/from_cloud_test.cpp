#include "coppice/extract/cloud/from_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stop_token>
#include <string>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/skeleton/measure.h"
#include "extract/cloud_support.h"

namespace coppice {
namespace {

double distance_to_axis(const Skeleton& s, Vec3d p) {
    double best = 1e300;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const Segment q = s.segment(n);
        const Vec3d a(q.a), d = Vec3d(q.b) - a;
        const double t = std::clamp(dot(p - a, d) / std::max(dot(d, d), 1e-30), 0.0, 1.0);
        best = std::min(best, distance(p, a + d * t));
    }
    return best;
}

double mean_radius(const Skeleton& s) {
    double sum = 0;
    for (const float r : s.radii()) sum += r;
    return sum / s.size();
}

std::string error_of(const PointSet& set, const CloudOptions& options = {}) {
    try {
        extract_from_cloud(set, options);
    } catch (const InvalidInput& e) {
        return e.what();
    }
    return "no error";
}

TEST(FromCloud, FindsTheAxisOfACylinder) {
    PointSet set;
    strew_cone(set, {1, 2, 0}, {1, 2, 3}, 0.1, 0.1, 6000, 0.002);
    const CloudExtraction found = extract_from_cloud(set);
    const SkeletonMeasures m = measure(found.skeleton);
    EXPECT_EQ(m.trees, 1u);
    EXPECT_EQ(m.tips, 1u);
    EXPECT_NEAR(m.length, 3, 0.1);
    EXPECT_NEAR(mean_radius(found.skeleton), 0.1, 0.003);
    for (const double z : {0.2, 1.0, 2.0, 2.8})
        EXPECT_LT(distance_to_axis(found.skeleton, {1, 2, z}), 0.01) << z;
}

TEST(FromCloud, FitsAStemSeenFromOneSide) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 3}, 0.1, 0.1, 4000, 0.002, true);
    const CloudExtraction found = extract_from_cloud(set);
    // The mean of a half circle is 2 r / pi = 64 mm from its centre.
    for (const double z : {0.5, 1.5, 2.5}) EXPECT_LT(distance_to_axis(found.skeleton, {0, 0, z}), 0.02) << z;
    EXPECT_NEAR(mean_radius(found.skeleton), 0.1, 0.01);
}

TEST(FromCloud, FindsForksAndTips) {
    const CloudExtraction found = extract_from_cloud(fork_cloud(0.002));
    const SkeletonMeasures m = measure(found.skeleton);
    EXPECT_EQ(m.trees, 1u);
    EXPECT_EQ(m.tips, 2u);
    EXPECT_EQ(m.branch_nodes, 1u);
    EXPECT_NEAR(m.length, 4, 0.25);
    for (const Vec3d p : {Vec3d{0, 0, 1}, Vec3d{0.3, 0, 2.4}, Vec3d{-0.3, 0.05, 2.4}, Vec3d{0.57, 0, 2.76}}) {
        EXPECT_LT(distance_to_axis(found.skeleton, p), 0.03);
    }
    // Cones: pi/3 (2 (0.1^2 + 0.1 0.08 + 0.08^2) + 2 (0.06^2 + 0.06 0.05 + 0.05^2)) = 0.0702.
    EXPECT_NEAR(m.volume, 0.0702, 0.007);
}

/// Returns a stem with a whorl of four branches, at `points` per square metre, from five seeds.
PointSet whorl_cloud(double points, std::uint64_t first_seed) {
    PointSet set;
    const auto strew = [&](Vec3d a, Vec3d b, double r, std::uint64_t seed) {
        const double area = 2 * 3.14159 * r * distance(a, b);
        strew_cone(set, a, b, r, r, static_cast<int>(points * area), 0.001, false, seed);
    };
    strew({0, 0, 0}, {0, 0, 2}, 0.08, first_seed);
    // They begin at the surface of the stem, as in a scan.
    for (std::uint64_t k = 0; k < 4; ++k) {
        const double turn = 1.570796 * static_cast<double>(k);
        const Vec3d out{std::cos(turn), std::sin(turn), 0.5};
        strew(Vec3d{0, 0, 1.2} + out * 0.08, Vec3d{0, 0, 1.2} + out * 0.6, 0.02, first_seed + 1 + k);
    }
    return set;
}

// From a spacing of 7 mm, a third of a branch's radius, to one of 23 mm, above its radius.
TEST(FromCloud, FindsAWhorlAtAnyDensity) {
    for (const double density : {30'000.0, 8'000.0, 2'500.0}) {
        for (const std::uint64_t seed : {1, 21}) {
            const CloudExtraction found = extract_from_cloud(whorl_cloud(density, seed));
            const SkeletonMeasures m = measure(found.skeleton);
            EXPECT_EQ(m.trees, 1u) << density;
            EXPECT_EQ(m.tips, 5u) << density << ", seed " << seed;
            // 2 m and four times 0.6 sqrt(1.25) from the axis.
            EXPECT_NEAR(m.length, 2 + 4 * 0.6708, 0.2) << density;
            for (const Vec3d p :
                 {Vec3d{0.3, 0, 1.35}, Vec3d{0, 0.5, 1.45}, Vec3d{-0.5, 0, 1.45}, Vec3d{0, -0.3, 1.35}})
                EXPECT_LT(distance_to_axis(found.skeleton, p), 0.012) << density << ", seed " << seed;
        }
    }
}

TEST(FromCloud, FindsSeveralTrees) {
    PointSet set = fork_cloud();
    strew_cone(set, {5, 0, 0.1}, {5, 0.2, 2.5}, 0.08, 0.06, 3000);
    const CloudExtraction found = extract_from_cloud(set);
    EXPECT_EQ(found.skeleton.tree_count(), 2u);
    EXPECT_LT(distance_to_axis(found.skeleton, {5, 0.1, 1.3}), 0.02);
    const CloudExtraction one = extract_from_cloud(set, {.max_trees = 1});
    EXPECT_EQ(one.skeleton.tree_count(), 1u);
    EXPECT_EQ(one.cleaning.unreached, 3000u);
}

TEST(FromCloud, StartsAtTheGivenRoot) {
    PointSet set;
    set.origin = {500000, 4000000, 100};
    strew_cone(set, {0, 0, 0}, {0, 0, 2}, 0.05, 0.05, 3000);
    const CloudExtraction found = extract_from_cloud(set, {.root = Vec3d{500000, 4000000, 102}});
    EXPECT_GT(found.skeleton.position(NodeId(0)).z, 1.9f);
    EXPECT_EQ(found.skeleton.origin(), set.origin);
}

TEST(FromCloud, BridgesGapsUpToTheGivenWidth) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 1}, 0.05, 0.05, 2000);
    strew_cone(set, {0.25, 0, 0.9}, {1, 0, 1.2}, 0.05, 0.05, 1600);
    const CloudExtraction wide = extract_from_cloud(set, {.gap = 0.3f});
    EXPECT_EQ(wide.report.joined, 1u);
    // The bridge is on the surface, so that the axis bends towards it.
    EXPECT_NEAR(measure(wide.skeleton).length, 2, 0.2);
    const CloudExtraction narrow = extract_from_cloud(set, {.gap = 0.1f, .max_trees = 1});
    EXPECT_EQ(narrow.report.joined, 0u);
    EXPECT_LT(measure(narrow.skeleton).length, 1.1);
    EXPECT_EQ(narrow.cleaning.unreached, 1600u);
}

/// Returns a stem with limbs that lean out, without points in a band across all of them.
PointSet limbs_with_a_band() {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 1.5}, 0.06, 0.06, 3000, 0.002);
    for (int k = 0; k < 5; ++k) {
        const double turn = 0.4 * std::numbers::pi * k;
        strew_cone(set, {0, 0, 1.2}, {1.2 * std::cos(turn), 1.2 * std::sin(turn), 4}, 0.03, 0.02, 2500,
                   0.002);
    }
    std::erase_if(set.positions, [](Vec3 p) { return std::abs(p.z - 2.4f) < 0.25f; });
    return set;
}

TEST(FromCloud, ContinuesLimbsStraightAcrossAGap) {
    const CloudExtraction found = extract_from_cloud(limbs_with_a_band());
    const SkeletonMeasures m = measure(found.skeleton);
    EXPECT_EQ(m.trees, 1u);
    EXPECT_EQ(found.cleaning.unreached, 0u);
    for (int k = 0; k < 5; ++k) {
        const double turn = 0.4 * std::numbers::pi * k, out = 1.2 * 1.2 / 2.8;
        EXPECT_LT(distance_to_axis(found.skeleton, {out * std::cos(turn), out * std::sin(turn), 2.4}), 0.05);
    }
}

TEST(FromCloud, DoesNotExtractTreesFromLoosePartsOfACrown) {
    PointSet set = limbs_with_a_band();
    strew_cone(set, {0.1, 0.1, 6}, {0.4, 0.1, 8}, 0.03, 0.03, 2500, 0.002);  // beyond any gap
    const CloudExtraction found = extract_from_cloud(set);
    EXPECT_EQ(found.skeleton.tree_count(), 1u);
    EXPECT_EQ(found.cleaning.unreached, 2500u);
}

TEST(FromCloud, ExtractsATreeHigherOnASlope) {
    PointSet set;
    for (const double x : {0.0, 3.0}) {
        strew_cone(set, {x, 0, x}, {x, 0, x + 4}, 0.08, 0.05, 5000, 0.002);
        strew_cone(set, {x, 0, x + 3}, {x + 1.5, 0, x + 4}, 0.03, 0.02, 1500, 0.002);
    }
    const CloudExtraction found = extract_from_cloud(set);
    EXPECT_EQ(found.skeleton.tree_count(), 2u);
    EXPECT_LT(found.cleaning.unreached, 10u);
}

TEST(FromCloud, OutliersWithinReachAreNotCountedAsReached) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 4}, 0.1, 0.08, 8000, 0.002);
    for (int k = 0; k < 5; ++k)  // not on the stem, but within its reach
        set.positions.push_back({0.126f * std::cos(1.2f * static_cast<float>(k)),
                                 0.126f * std::sin(1.2f * static_cast<float>(k)),
                                 1 + 0.5f * static_cast<float>(k)});
    const CloudExtraction found = extract_from_cloud(set, {.outlier_factor = 1.6f});
    EXPECT_GT(found.cleaning.outliers, 0u);
    EXPECT_LT(found.cleaning.unreached, 100u);
}

TEST(FromCloud, ExtractsFewTwigsFromNeedles) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 5}, 0.08, 0.05, 3000, 0.002);
    for (int k = 0; k < 6; ++k) {
        const Vec3d from{0, 0, 2 + 0.4 * k}, to = from + Vec3d{2 * std::cos(k), 2 * std::sin(k), 1};
        strew_cone(set, from, to, 0.02, 0.01, 300, 0.002, false, 2 + k);
        strew_cone(set, from, to, 0.01, 0.01, 600, 0.1, false, 9 + k);
    }
    // The total length is 18.4 m; 28 m are found if needles are treated like other points.
    EXPECT_LT(measure(extract_from_cloud(set).skeleton).length, 25);
}

PointSet tree_on_ground(double noise) {
    PointSet set = fork_cloud(noise);
    const CounterRandom random(9, 1);
    for (std::uint64_t i = 0; i < 8000; ++i) {
        const double x = random.uniform(3 * i, -2, 2), y = random.uniform(3 * i + 1, -2, 2);
        set.positions.push_back(Vec3(Vec3d{x, y, 0.1 * x + random.uniform(3 * i + 2, -0.01, 0.01)}));
    }
    return set;
}

TEST(FromCloud, ExcludesTheGround) {
    for (const double noise : {0.0, 0.005}) {
        const PointSet set = tree_on_ground(noise);
        const CloudExtraction found = extract_from_cloud(set);
        EXPECT_GE(found.cleaning.ground, 8000u);
        EXPECT_LT(found.cleaning.ground, 8300u);
        EXPECT_EQ(measure(found.skeleton).tips, 2u) << noise;
        EXPECT_EQ(extract_from_cloud(set, {.ground = GroundRule::none}).cleaning.ground, 0u);
    }
    // A tree alone has no ground.
    EXPECT_EQ(extract_from_cloud(fork_cloud()).cleaning.ground, 0u);
}

TEST(FromCloud, ExcludesUnderstorey) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 4}, 0.08, 0.05, 6000, 0.002);
    const CounterRandom random(9, 1);
    for (std::uint64_t i = 0; i < 12000; ++i)
        set.positions.push_back(Vec3(Vec3d{random.uniform(3 * i, -2, 2), random.uniform(3 * i + 1, -2, 2),
                                           random.uniform(3 * i + 2, -0.01, 0.01)}));
    const CloudExtraction alone = extract_from_cloud(set);
    const std::size_t before = set.size();
    for (int k = 0; k < 6; ++k)
        strew_cone(set, {1.2, 0.3 * k - 0.6, 0}, {1 + 0.1 * k, 0.3 * k - 0.6, 0.7}, 0.02, 0.02, 300, 0.01);
    const CloudExtraction found = extract_from_cloud(set);
    EXPECT_EQ(alone.cleaning.understorey, 0u);
    EXPECT_GT(found.cleaning.understorey, 0.7 * static_cast<double>(set.size() - before));
    EXPECT_NEAR(measure(found.skeleton).length, measure(alone.skeleton).length, 0.1);
}

TEST(FromCloud, ExcludesPointsBelowAHeight) {
    PointSet set = fork_cloud();
    set.origin = {0, 0, 100};
    const CloudExtraction found =
        extract_from_cloud(set, {.ground = GroundRule::height, .ground_height = 101});
    EXPECT_NEAR(measure(found.skeleton).length, 3, 0.25);
    EXPECT_GT(found.skeleton.bounds().low.z, 0.85f);
}

TEST(FromCloud, CleansTheCloudAndCountsTheRemovedPoints) {
    PointSet set = fork_cloud();
    const std::size_t clean = set.size();
    for (std::size_t i = 0; i < 50; ++i) set.positions.push_back(set.positions[i]);
    for (const float x : {-3.0f, 3.0f}) set.positions.push_back({x, 4, 1});
    const CloudExtraction found = extract_from_cloud(set);
    EXPECT_EQ(found.cleaning.points, clean + 52);
    EXPECT_EQ(found.cleaning.duplicates, 50u);
    EXPECT_EQ(found.cleaning.outliers, 2u);
    EXPECT_NEAR(measure(found.skeleton).length, 4, 0.25);
    const CloudExtraction thin = extract_from_cloud(set, {.voxel = 0.05f});
    EXPECT_GT(thin.cleaning.downsampled, 3000u);
    EXPECT_NEAR(measure(thin.skeleton).length, 4, 0.4);
    const CloudExtraction few = extract_from_cloud(set, {.max_points = 1000});
    EXPECT_LE(few.report.samples, 1000u);
}

TEST(FromCloud, ReportsConfidenceAndResidual) {
    const CloudExtraction found = extract_from_cloud(fork_cloud(0.002));
    ASSERT_EQ(found.confidence.size(), found.skeleton.size());
    std::uint64_t samples = 0;
    for (const NodeConfidence& c : found.confidence) samples += c.samples;
    EXPECT_EQ(samples, found.report.samples);
    // All points except a few about the rim of the stem are on the extracted surface.
    EXPECT_GT(samples, 6700u);
    EXPECT_LT(found.report.residual, 0.1f);
}

TEST(FromCloud, ReportsBoundsOfRadii) {
    const CloudExtraction found = extract_from_cloud(fork_cloud(0.002));
    double seen = 0;
    for (const NodeId n : nodes(found.skeleton)) {
        const NodeConfidence& c = found.confidence[n.index()];
        EXPECT_LT(c.radius_low, found.skeleton.radius(n));
        EXPECT_GT(c.radius_high, found.skeleton.radius(n));
        seen += c.evidence;
    }
    EXPECT_GT(seen, 0.8 * static_cast<double>(found.skeleton.size()));
    EXPECT_LT(found.report.inferred, 0.5);
}

/// Returns a stem with two limbs that end in clusters of points.
PointSet clusters() {
    PointSet set = fork_cloud(0.003);
    const CounterRandom random(5, 5);
    std::uint64_t draw = 0;
    for (const Vec3d at : {Vec3d{0.8, 0, 3}, Vec3d{-0.8, 0.1, 3}, Vec3d{0.9, 0.3, 3.3}}) {
        for (int i = 0; i < 300; ++i) {
            const double x = random.uniform(draw++, -1, 1), y = random.uniform(draw++, -1, 1);
            const double z = random.uniform(draw++, -1, 1);
            if (x * x + y * y + z * z < 1) set.positions.push_back(Vec3(at + Vec3d{x, y, z} * 0.25));
        }
    }
    return set;
}

TEST(FromCloud, RadiiNeverIncreaseTowardsTheTips) {
    for (const PointSet& set : {fork_cloud(0.004), tree_on_ground(0.005), clusters()}) {
        const Skeleton s = extract_from_cloud(set).skeleton;
        for (const NodeId n : nodes(s)) {
            if (!s.is_root(n)) {
                EXPECT_LE(s.radius(n), s.radius(s.parent(n)));
            }
        }
    }
}

TEST(FromCloud, ReturnsLeavesExactlyAsTheyWereGiven) {
    const PointSet set = clusters();
    const CloudExtraction found = extract_from_cloud(set);
    ASSERT_GT(found.leaves.size(), 50u);
    for (const Vec3 leaf : found.leaves.positions) EXPECT_TRUE(std::ranges::count(set.positions, leaf) > 0);
}

TEST(FromCloud, DoesNotExtractThickBranchesFromClusters) {
    const CloudExtraction found = extract_from_cloud(clusters(), {.leaves = LeafRule::keep});
    const Skeleton& s = found.skeleton;
    // The limbs are 5 cm thick at their ends; the clusters have a size of half a metre, and a branch leads to
    // each.
    for (const Vec3d at : {Vec3d{0.8, 0, 3}, Vec3d{-0.8, 0.1, 3}, Vec3d{0.9, 0.3, 3.3}}) {
        bool reached = false;
        for (const NodeId n : nodes(s)) {
            if (distance(Vec3d(s.position(n)), at) > 0.25) continue;
            reached = true;
            EXPECT_LT(s.radius(n), 0.08f);
        }
        EXPECT_TRUE(reached);
    }
    EXPECT_NEAR(s.radii()[0], 0.1, 0.01);
    EXPECT_GT(found.report.inferred, 0.3);
}

TEST(FromCloud, IsBitIdenticalForAnyNumberOfThreads) {
    const PointSet set = tree_on_ground(0.005);
    const CloudExtraction one = extract_from_cloud(set, {}, {.threads = 1});
    for (const unsigned threads : {2u, 7u}) {
        const CloudExtraction more = extract_from_cloud(set, {}, {.threads = threads});
        ASSERT_EQ(more.skeleton.size(), one.skeleton.size());
        EXPECT_TRUE(std::ranges::equal(more.skeleton.positions(), one.skeleton.positions()));
        EXPECT_TRUE(std::ranges::equal(more.skeleton.radii(), one.skeleton.radii()));
        EXPECT_TRUE(std::ranges::equal(more.skeleton.parents(), one.skeleton.parents()));
        EXPECT_EQ(more.confidence, one.confidence);
    }
}

TEST(FromCloud, ResultMovesAndTurnsWithTheCloud) {
    PointSet set = fork_cloud(0.01);
    const Skeleton before = extract_from_cloud(set).skeleton;
    const double cosine = std::cos(2.5), sine = std::sin(2.5);
    const auto turn = [&](Vec3 p) {
        return Vec3(Vec3d{cosine * p.x - sine * p.y + 3, sine * p.x + cosine * p.y - 7, p.z});
    };
    for (Vec3& p : set.positions) p = turn(p);
    std::ranges::reverse(set.positions);
    set.origin = {500000, 0, 0};
    const Skeleton after = extract_from_cloud(set).skeleton;
    EXPECT_EQ(after.origin(), set.origin);
    EXPECT_NEAR(measure(after).length, measure(before).length, 0.01 * measure(before).length);
    EXPECT_NEAR(measure(after).volume, measure(before).volume, 0.01 * measure(before).volume);
    for (const Vec3 p : before.positions()) EXPECT_LT(distance_to_axis(after, Vec3d(turn(p))), 0.01);
}

TEST(FromCloud, RejectsCloudsWithoutATree) {
    PointSet set;
    EXPECT_EQ(error_of(set), "extract: 0 points are left in the cloud, but a skeleton needs at least 20");
    for (int i = 0; i < 1000; ++i) set.positions.push_back({1, 2, 3});
    EXPECT_EQ(error_of(set), "extract: 1 points are left after cleaning, but a skeleton needs at least 20");
    EXPECT_EQ(error_of(fork_cloud(), {.ground = GroundRule::height, .ground_height = 10}),
              "extract: 0 points are left after cleaning, but a skeleton needs at least 20");
    EXPECT_EQ(error_of(fork_cloud(), {.neighbours = 3}),
              "extract: neighbours must be between 4 and 64, but is 3");
}

TEST(FromCloud, TerminatesOnDegenerateClouds) {
    PointSet line, grid, far;
    const CounterRandom random(4, 1);
    for (int i = 0; i < 300; ++i) line.positions.push_back({0, 0, static_cast<float>(i)});
    for (int i = 0; i < 1000; ++i) {
        grid.positions.push_back(
            {static_cast<float>(i % 10), static_cast<float>(i / 10 % 10), static_cast<float>(i / 100)});
    }
    far = fork_cloud();
    far.positions.push_back({1e30f, -1e30f, 1e30f});
    PointSet ball;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        ball.positions.push_back(
            Vec3(Vec3d{random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2)}));
    }
    for (const PointSet& set : {line, grid, far, ball}) {
        const CloudExtraction found = extract_from_cloud(set);
        EXPECT_GE(found.skeleton.size(), 1u);
    }
}

TEST(FromCloud, StopsWhenCancelledAndReportsProgress) {
    std::stop_source source;
    source.request_stop();
    EXPECT_THROW(extract_from_cloud(fork_cloud(), {}, {.stop = source.get_token()}), Cancelled);
    float last = 0;
    bool rises = true;
    extract_from_cloud(fork_cloud(), {}, {.progress = [&](float f) {
                           rises = rises && f >= last && f <= 1;
                           last = f;
                       }});
    EXPECT_TRUE(rises);
    EXPECT_EQ(last, 1);
}

// Requests cancellation at each progress report from the first to the last but one; uses counts of reports
// instead of a clock.
TEST(FromCloud, StopsBeforeTheNextProgressReport) {
    const PointSet set = whorl_cloud(5'000, 21);
    int all = 0;
    extract_from_cloud(set, {}, {.progress = [&](float) { ++all; }});
    ASSERT_GT(all, 8);
    for (int k = 0; k < 8; ++k) {
        const int requested = 1 + k * (all - 2) / 8;
        std::stop_source source;
        int reports = 0;
        const auto progress = [&](float) {
            if (++reports == requested) source.request_stop();
        };
        EXPECT_THROW(extract_from_cloud(set, {}, {.stop = source.get_token(), .progress = progress}),
                     Cancelled);
        EXPECT_LE(reports, requested + 1) << "stopped at report " << requested << " of " << all;
    }
}

}  // namespace
}  // namespace coppice
