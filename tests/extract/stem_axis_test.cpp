#include "coppice/extract/stem/stem_axis_internal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/stem/tree_figures.h"
#include "coppice/skeleton/measure.h"
#include "extract/cloud_support.h"

namespace coppice::extract_internal {
namespace {

/// Adds a stem from `foot` that leans by 0.1 in x and tapers from `radius` to a third of it over 8 m.
void add_stem(PointSet& set, Vec3d foot, double radius, int count = 20000, std::uint64_t seed = 1) {
    strew_cone(set, foot, foot + Vec3d{0.8, 0, 8}, radius, radius / 3, count, 0.004, false, seed);
}

std::vector<StemAxis> find_axes(const PointSet& set, const StemAxisSearch& search = {}) {
    return find_stem_axes(set.positions, {}, search, {});
}

TEST(StemAxis, StartsAtTheFootAndFollowsTheStem) {
    PointSet set;
    add_stem(set, {0, 0, 0}, 0.15);
    const auto axes = find_axes(set);
    ASSERT_EQ(axes.size(), 1u);
    const StemAxis& axis = axes[0];
    EXPECT_LT(length(axis.position.front()), 0.02);
    EXPECT_GT(axis.position.back().z, 7);
    EXPECT_NEAR(axis.breast.diameter, 2 * (0.15 - 0.1 * 1.3 / 8), 0.003);
    for (std::size_t i = 0; i < axis.position.size(); ++i) {
        const Vec3d p = axis.position[i];
        EXPECT_LT(std::hypot(p.x - 0.1 * p.z, p.y), 0.01) << p.z;
        EXPECT_NEAR(axis.radius[i], 0.15 - 0.1 * p.z / 8, 0.006) << p.z;
        if (i > 0) {
            EXPECT_LE(axis.radius[i], axis.radius[i - 1]);
        }
    }
    EXPECT_TRUE(is_on_stem(axes, {0.4, 0.1, 4}, 0.01));
    EXPECT_FALSE(is_on_stem(axes, {0.4, 0.2, 4}, 0.01));
}

TEST(StemAxis, FollowsABendOfTheStem) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 4}, 0.1, 0.09, 12000, 0.002, false, 1);
    strew_cone(set, {0, 0, 4}, {1.5, 0, 6}, 0.09, 0.07, 8000, 0.002, false, 2);
    const auto axes = find_axes(set);
    ASSERT_EQ(axes.size(), 1u);
    for (const Vec3d p : axes[0].position) {
        const double off = p.z < 4 ? p.x : (p.x - 0.75 * (p.z - 4)) * 0.8;
        EXPECT_LT(std::abs(off), 0.03) << p.z;
    }
}

TEST(StemAxis, SectionsAreAcrossALimbThatContinuesTheStem) {
    for (int k = 0; k < 8; ++k) {
        const double turn = 0.7 * k;
        const Vec3d out{0.6 * std::cos(turn), 0.6 * std::sin(turn), 0.8};
        PointSet set;
        strew_cone(set, {0, 0, 0}, {0, 0, 2}, 0.1, 0.08, 4000, 0, false, 1);
        strew_cone(set, {0, 0, 2}, Vec3d{0, 0, 2} + out, 0.06, 0.05, 1400, 0, false, 2);
        strew_cone(set, {0, 0, 2}, Vec3d{-out.x, -out.y, 2.8}, 0.06, 0.05, 1400, 0, false, 3);
        const auto axes = find_axes(set);
        ASSERT_EQ(axes.size(), 1u);
        for (std::size_t i = 0; i < axes[0].position.size(); ++i) {
            const Vec3d p = axes[0].position[i];
            if (p.z < 2.3) continue;
            EXPECT_NEAR(std::hypot(p.x, p.y), 0.75 * (p.z - 2), 0.02) << k << ": " << p.z;
            EXPECT_NEAR(axes[0].radius[i], 0.06 - 0.0125 * (p.z - 2), 0.005) << k << ": " << p.z;
        }
    }
}

TEST(StemAxis, FindsOneAxisPerStemOnTheGround) {
    PointSet set;
    add_stem(set, {0, 0, 0}, 0.15, 20000, 1);
    add_stem(set, {3, 0, 0}, 0.1, 15000, 2);
    // A limb near the first stem that is not connected to the ground.
    strew_cone(set, {-1, 0, 1.2}, {-1.2, 0, 4}, 0.08, 0.06, 6000, 0.004, false, 3);
    const auto axes = find_axes(set);
    ASSERT_EQ(axes.size(), 2u);
    EXPECT_LT(length(axes[0].position.front()), 0.03);
    EXPECT_LT(distance(axes[1].position.front(), Vec3d{3, 0, 0}), 0.03);
    EXPECT_EQ(find_axes(set, {.max_trees = 1}).size(), 1u);
    const auto chosen = find_axes(set, {.root = Vec3d{3.05, 0, 0.1}});
    ASSERT_EQ(chosen.size(), 1u);
    EXPECT_NEAR(chosen[0].position.front().z, 0.1, 1e-6);
    EXPECT_NEAR(chosen[0].position.front().x, 3, 0.05);
}

TEST(StemAxis, GrowthDirectionsPointAwayFromALowerPointOfTheStem) {
    StemAxis stem;
    stem.position = {{0, 0, 0}, {0, 0, 10}};
    stem.radius = {0.1, 0.1};
    const std::vector<Vec3> points{{1, 0, 5}, {0, 2, 12}, {0, 0, 3}};
    const Buffer<Vec3> out = growth_directions(points, {&stem, 1}, {}, {});
    EXPECT_LT(distance(Vec3d(out[0]), normalized(Vec3d{1, 0, 1})), 1e-6);
    EXPECT_LT(distance(Vec3d(out[1]), normalized(Vec3d{0, 2, 2})), 1e-6);
    EXPECT_LT(distance(Vec3d(out[2]), Vec3d{0, 0, 1}), 1e-6);
}

/// Returns a tree with four limbs.
PointSet limbed_tree() {
    PointSet set;
    add_stem(set, {0, 0, 0}, 0.15);
    for (int k = 0; k < 4; ++k) {
        const double turn = 1.6 * k, z = 3 + k;
        const Vec3d from{0.1 * z, 0, z};
        strew_cone(set, from, from + Vec3d{1.5 * std::cos(turn), 1.5 * std::sin(turn), 1}, 0.05, 0.03, 2000,
                   0.003, false, static_cast<std::uint64_t>(k) + 5);
    }
    return set;
}

TEST(StemAxis, SkeletonStartsWithTheStemAxis) {
    PointSet set = limbed_tree();
    // Outliers about the tree and below it, as caused by rain or dust.
    const CounterRandom random(3, 1);
    for (std::uint64_t i = 0; i < 150; ++i) {
        set.positions.push_back(Vec3(Vec3d{random.uniform(3 * i, -3, 3), random.uniform(3 * i + 1, -3, 3),
                                           random.uniform(3 * i + 2, -1, 9)}));
    }
    const CloudExtraction found = extract_from_cloud(set);
    const Skeleton& s = found.skeleton;
    ASSERT_EQ(s.tree_count(), 1u);
    EXPECT_LT(length(Vec3d(s.position(NodeId(0)))), 0.1);
    ASSERT_EQ(found.trees.size(), 1u);
    const TreeFigures& tree = found.trees[0];
    EXPECT_NEAR(tree.dbh, 0.2675, 0.006);
    EXPECT_NEAR(tree.dbh, tree.dbh_of_points, 0.02 * tree.dbh);
    EXPECT_TRUE(tree.doubts.empty()) << tree.doubts[0];
    // The cones of the stem and the portions of the limbs outside it.
    const double pi = 3.14159, stem = pi / 3 * 8.04 * (0.0225 + 0.0075 + 0.0025);
    const double limbs = 4 * pi / 3 * 1.7 * (0.0025 + 0.0015 + 0.0009);
    EXPECT_NEAR(tree.volume, stem + limbs, 0.1 * (stem + limbs));
    EXPECT_LT(tree.volume_low, stem + limbs);
    EXPECT_GT(tree.volume_high, stem + limbs);
    EXPECT_LT(tree.volume_high / tree.volume_low, 1.6);
}

TEST(TreeFigures, ReportDoubtAboutImplausibleTrees) {
    // A stem of 10 m with a radius of 0.1 m, and a limb of ten times its volume.
    const std::vector<NodeId> parents{NodeId(), NodeId(0), NodeId(1)};
    const std::vector<Vec3> positions{{0, 0, 0}, {0, 0, 10}, {10, 0, 10}};
    const std::vector<float> radii{0.1f, 0.1f, 0.5f};
    const Skeleton s(parents, positions, radii, {});
    std::vector<NodeConfidence> confidence(3);
    confidence[2].evidence = 0;
    const auto doubts = [&](std::vector<SeenStem> stems) {
        return tree_figures(s, confidence, stems).at(0).doubts;
    };
    const auto unseen = doubts({});
    ASSERT_EQ(unseen.size(), 3u);
    EXPECT_EQ(unseen[0], "no circle is seen at breast height");
    EXPECT_NE(unseen[1].find("times the volume that its diameter and height suggest"), std::string::npos);
    EXPECT_NE(unseen[2].find("% of its volume is inferred"), std::string::npos);
    SeenStem seen;
    seen.breast.diameter = 0.3;
    seen.breast.deviation = 0.01;
    const TreeFigures known = tree_figures(s, confidence, std::vector{seen}).at(0);
    EXPECT_NEAR(known.dbh_high - 0.3, 1.645 * std::hypot(0.01, 0.025 * 0.3), 1e-9);
    EXPECT_NEAR(0.3 - known.dbh_low, known.dbh_high - 0.3, 1e-12);
    seen.breast.deviation = 0.3;  // hardly any information
    EXPECT_EQ(tree_figures(s, confidence, std::vector{seen}).at(0).dbh_low, 0);
    EXPECT_EQ(doubts({seen})[0], "the diameter at breast height is 20.0 cm, but 30.0 cm in the points");
}

TEST(TreeFigures, VolumeBoundsFollowTheBoundsOfRadii) {
    const std::vector<NodeId> parents{NodeId(), NodeId(0)};
    const std::vector<Vec3> positions{{0, 0, 0}, {0, 0, 12}};
    const std::vector<float> radii{0.1f, 0.1f};
    const Skeleton s(parents, positions, radii, {});
    std::vector<NodeConfidence> confidence(2);
    const TreeFigures known = tree_figures(s, confidence, {}).at(0);
    EXPECT_NEAR(known.volume, 0.12 * 3.14159, 1e-4);
    EXPECT_NEAR(known.volume_high / known.volume, std::exp(1.645 * 0.03), 1e-6);
    EXPECT_NEAR(known.form, 2 * std::pow(1 - 1.3 / 12.1, 2) * 12 / 12.1, 0.01);
    confidence[1].radius_low = 0.05f;
    confidence[1].radius_high = 0.2f;
    const TreeFigures open = tree_figures(s, confidence, {}).at(0);
    EXPECT_GT(open.volume_high, 2.5 * open.volume);
    EXPECT_NEAR(open.volume * open.volume, open.volume_low * open.volume_high, 1e-6);
}

/// A stem of 12 m with points, and an inferred limb of 4 m without points.
struct HalfSeen {
    Skeleton skeleton{std::vector<NodeId>{NodeId(), NodeId(0), NodeId(1)},
                      std::vector<Vec3>{{0, 0, 0}, {0, 0, 12}, {4, 0, 12}},
                      std::vector<float>{0.1f, 0.1f, 0.05f},
                      {}};
    std::vector<NodeConfidence> confidence{{}, {.samples = 400}, {.evidence = 0}};
};

TEST(TreeFigures, LengthBoundsWidenWithInferredBranches) {
    const HalfSeen tree;
    const TreeFigures known = tree_figures(tree.skeleton, tree.confidence, {}).at(0);
    EXPECT_NEAR(known.length, 16, 1e-5);
    // A quarter of the length is inferred, without points.
    EXPECT_NEAR(known.length_low, 12 / std::exp(0.03 + 0.35 / 4), 1e-4);
    EXPECT_NEAR(known.length_high, 16 * std::exp(0.03 + 0.3 / 4), 1e-4);
    std::vector<NodeConfidence> seen = tree.confidence;
    seen[2] = {.samples = 100};
    const TreeFigures all = tree_figures(tree.skeleton, seen, {}).at(0);
    EXPECT_NEAR(all.length_low, 16 / std::exp(0.03), 1e-4);
    EXPECT_NEAR(all.length_high, 16 * std::exp(0.03), 1e-4);
}

TEST(TreeFigures, HeightBoundsFollowTheSpacingOfPoints) {
    const HalfSeen tree;
    // 400 points on pi (12 (0.1 + 0.1) + 4 (0.1 + 0.05)) m2.
    const double margin = 0.02 + 2 * std::sqrt(3.14159 * 3 / 400);
    const TreeFigures known = tree_figures(tree.skeleton, tree.confidence, {}).at(0);
    EXPECT_NEAR(known.height, 12.1, 1e-5);
    EXPECT_NEAR(known.height_low, 12.1 - margin, 1e-4);
    EXPECT_NEAR(known.height_high, 12.1 + margin, 1e-4);
    SeenStem stem;
    stem.height = 13;  // there are points above the skeleton
    EXPECT_NEAR(tree_figures(tree.skeleton, tree.confidence, std::vector{stem}).at(0).height_high,
                13 + margin, 1e-4);
}

TEST(TreeFigures, OfASkeletonAloneHaveNoBounds) {
    const HalfSeen tree;
    const TreeFigures alone = tree_figures(tree.skeleton, {}).at(0);
    EXPECT_EQ(alone.length_high, 0);
    EXPECT_EQ(alone.height_high, 0);
    EXPECT_EQ(alone.volume_high, 0);
    EXPECT_EQ(alone.inferred, 0);
    ASSERT_EQ(alone.doubts.size(), 1u);  // a missing circle is not a doubt
    EXPECT_NE(alone.doubts[0].find("times the volume that its diameter and height suggest"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice::extract_internal
