#include "coppice/extract/plot/plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stop_token>

#include "coppice/base/error.h"
#include "coppice/skeleton/measure.h"
#include "extract/cloud_support.h"

namespace coppice {
namespace {

double slope(double x, double y) { return 0.2 * x + 0.15 * std::sin(y); }

struct Standing {
    double x, y, radius, height, lean;
};
// The first two are 2.4 m apart, and their branches of 1.5 m overlap; the last has points on one side only.
constexpr Standing kTrees[] = {
    {2, 2, 0.15, 9, 0}, {4.4, 2, 0.12, 8, 0.05}, {3, 6, 0.1, 7, 0.15}, {8, 5, 0.08, 6, 0}};

struct TruePlot {
    PointSet points;
    std::vector<std::uint32_t> owner;  ///< index of the tree; 10 = ground, 11 = bush
    void own(std::uint32_t by) { owner.resize(points.size(), by); }
};

TruePlot make_plot() {
    TruePlot plot;
    std::uint64_t seed = 1;
    for (std::uint32_t t = 0; t < 4; ++t) {
        const Standing& s = kTrees[t];
        const Vec3d foot{s.x, s.y, slope(s.x, s.y)}, along = normalized(Vec3d{s.lean, 0, 1});
        strew_cone(plot.points, foot, foot + along * s.height, s.radius, 0.3 * s.radius, 9000, 0.004, t == 3,
                   seed++);
        for (int k = 0; k < 10; ++k) {
            const double z = 2.5 + k * (s.height - 3) / 10, turn = 2.4 * k + t;
            const Vec3d from = foot + along * z;
            strew_cone(plot.points, from, from + Vec3d{1.5 * std::cos(turn), 1.5 * std::sin(turn), 0.7}, 0.03,
                       0.01, 500, 0.002, false, seed++);
        }
        plot.own(t);
    }
    const Vec3d bush{6, 3, slope(6, 3)};
    for (int k = 0; k < 8; ++k)
        strew_cone(plot.points, bush, bush + Vec3d{0.4 * std::cos(k), 0.4 * std::sin(k), 0.8}, 0.01, 0.01,
                   150, 0, false, seed++);
    plot.own(11);
    const CounterRandom random(8, 8);
    for (std::uint64_t i = 0; i < 30000; ++i) {
        const double x = random.uniform(3 * i, -1, 10), y = random.uniform(3 * i + 1, -1, 8);
        plot.points.positions.push_back(Vec3(Vec3d{x, y, slope(x, y) + 0.02 * random.uniform(3 * i + 2)}));
    }
    plot.own(10);
    return plot;
}

/// Returns the index of the found tree at the position of this one.
std::size_t found_at(const std::vector<StemForm>& found, const Standing& tree) {
    for (std::size_t i = 0; i < found.size(); ++i)
        if (std::hypot(found[i].foot.x - tree.x, found[i].foot.y - tree.y) < 0.1) return i;
    return found.size();
}

TEST(Plot, FindsTreesOnASlopeAndAssignsTheirPoints) {
    const TruePlot plot = make_plot();
    const PlotSegments segments = segment_plot(plot.points);
    EXPECT_TRUE(segments.terrain.is_ground);
    ASSERT_EQ(segments.trees.size(), 4u);
    std::array<std::size_t, 4> at{};
    for (std::size_t t = 0; t < 4; ++t) {
        at[t] = found_at(segments.trees, kTrees[t]);
        ASSERT_LT(at[t], 4u) << t;
        const StemForm& form = segments.trees[at[t]];
        // The radius at the top is three tenths of that at the foot.
        const double dbh = 2 * kTrees[t].radius * (1 - 0.7 * 1.3 / kTrees[t].height);
        EXPECT_NEAR(form.breast.diameter, dbh, 0.03 * dbh) << t;
        EXPECT_NEAR(form.height, kTrees[t].height, 0.5) << t;
        EXPECT_NEAR(form.foot.z, slope(kTrees[t].x, kTrees[t].y), 0.1) << t;
    }
    double wood = 0, right = 0, bush = 0, bush_given = 0, ground = 0, ground_right = 0;
    for (std::size_t i = 0; i < plot.owner.size(); ++i) {
        const std::uint32_t owner = plot.owner[i], given = segments.tree_of[i];
        if (owner < 4) wood += 1, right += given == at[owner];
        if (owner == 11) bush += 1, bush_given += given < 4;
        if (owner == 10) ground += 1, ground_right += given == kPointOfGround;
    }
    EXPECT_GT(right / wood, 0.95);
    EXPECT_LT(bush_given / bush, 0.05);
    EXPECT_GT(ground_right / ground, 0.98);
}

TEST(Plot, SegmentsByTheTreeIdsOfPoints) {
    const TruePlot plot = make_plot();
    // Unsorted ids; the bush is also a tree because it has an id, but 30 points of ground are not.
    constexpr std::array<std::uint32_t, 4> kIds{9, 2, 70000, 4};
    std::vector<std::uint32_t> ids;
    for (const std::uint32_t owner : plot.owner) ids.push_back(owner < 4 ? kIds[owner] : owner == 11 ? 5 : 0);
    std::fill(ids.end() - 30, ids.end(), 6);
    const PlotSegments found = segment_plot_by_ids(plot.points, ids);
    EXPECT_EQ(found.ids, (std::vector<std::uint32_t>{2, 4, 5, 9, 70000}));
    ASSERT_EQ(found.trees.size(), 5u);
    const StemForm& thickest = found.trees[3];
    const double dbh = 2 * kTrees[0].radius * (1 - 0.7 * 1.3 / kTrees[0].height);
    EXPECT_NEAR(thickest.breast.diameter, dbh, 0.03 * dbh);
    EXPECT_NEAR(thickest.foot.z, slope(kTrees[0].x, kTrees[0].y), 0.1);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const std::uint32_t given = found.tree_of[i];
        if (given < 5) {
            ASSERT_EQ(found.ids[given], ids[i]) << i;
        }
        ASSERT_FALSE(plot.owner[i] < 4 && given == kPointOfNoTree) << i;
    }
    EXPECT_THROW(segment_plot_by_ids(plot.points, std::span(ids).first(5)), InvalidInput);
    EXPECT_TRUE(segment_plot_by_ids(plot.points, std::vector<std::uint32_t>(ids.size(), 0)).trees.empty());
}

TEST(Plot, ExtractsEachTreeFromTheGroundUp) {
    const TruePlot plot = make_plot();
    const PlotExtraction found = extract_plot(plot.points);
    ASSERT_EQ(found.trees.size(), 4u);
    for (const PlotTree& tree : found.trees) {
        ASSERT_TRUE(tree.result);
        const Skeleton& s = tree.result->skeleton;
        EXPECT_EQ(s.tree_count(), 1u);
        EXPECT_EQ(tree.result->confidence.size(), s.size());
        EXPECT_NEAR(s.origin().z + double{s.position(NodeId(0)).z}, tree.form.foot.z, 0.05);
        EXPECT_GT(tree.figures.length,
                  10);  // the stem and ten branches of 1.65 m each have a total length of some 24 m
        EXPECT_LT(tree.figures.length, 35);
        EXPECT_GT(tree.crown_base, 2);
        EXPECT_LT(tree.crown_base, 4);
        EXPECT_GT(tree.crown.area, 4);  // branches of 1.5 m all around cover at most 7.1 m2
        EXPECT_LT(tree.crown.area, 10);
        EXPECT_GT(tree.crown.hull_volume, 4);
        EXPECT_GT(tree.points, 10'000u);
    }
}

TEST(Plot, FailingTreesAreReportedWithoutStopping) {
    const TruePlot plot = make_plot();
    CloudOptions options;
    options.voxel = 20;  // no points of any tree are left
    const PlotExtraction found = extract_plot(plot.points, {}, options);
    ASSERT_EQ(found.trees.size(), 4u);
    for (const PlotTree& tree : found.trees) {
        EXPECT_FALSE(tree.result);
        ASSERT_FALSE(tree.warnings.empty());
        EXPECT_NE(tree.warnings.front().find("no skeleton: extract: "), std::string::npos);
        EXPECT_GT(tree.form.breast.diameter, 0);
    }
}

TEST(Plot, IntersectingBranchesContinueStraight) {
    // Two branches cross at right angles at (1.5, 1.5, 3): 2.1 m from the first stem, 2.9 m from the second.
    PointSet set;
    const Vec3d cross_at{1.5, 1.5, 3};
    strew_cone(set, {0, 0, 0}, {0, 0, 4}, 0.1, 0.08, 6000, 0.002, false, 1);
    strew_cone(set, {0, 0, 3}, {2.6, 2.6, 3}, 0.03, 0.02, 3000, 0.001, false, 2);
    const std::size_t first_end = set.size();
    strew_cone(set, {3.55, -0.55, 0}, {3.55, -0.55, 4}, 0.1, 0.08, 6000, 0.002, false, 3);
    const std::size_t second_branch = set.size();
    strew_cone(set, {3.55, -0.55, 3}, {0.4, 2.6, 3}, 0.03, 0.02, 3000, 0.001, false, 4);
    const std::size_t end = set.size();
    const CounterRandom random(8, 8);
    for (std::uint64_t i = 0; i < 10000; ++i)
        set.positions.push_back(
            Vec3(Vec3d{random.uniform(2 * i, -3, 6), random.uniform(2 * i + 1, -4, 4), 0}));
    const PlotSegments segments = segment_plot(set);
    ASSERT_EQ(segments.trees.size(), 2u);
    const std::uint32_t first = segments.tree_of[100], second = segments.tree_of[first_end + 100];
    EXPECT_NE(first, second);
    double beyond = 0, right = 0;
    for (std::size_t i = 0; i < end; ++i) {
        const Vec3d p(set.positions[i]);
        if (p.z < 2.9 || distance(p, cross_at) < 0.1) continue;
        const bool is_first = i < first_end;
        if (!is_first && i < second_branch) continue;
        beyond += 1;
        right += segments.tree_of[i] == (is_first ? first : second);
    }
    EXPECT_GT(right / beyond, 0.97);
}

TEST(Plot, ForkedStemsAreOneTree) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 0.5}, 0.16, 0.15, 2000, 0.003, false, 1);
    strew_cone(set, {0, 0, 0.5}, {1.5, 0, 6}, 0.1, 0.05, 6000, 0.003, false, 2);
    strew_cone(set, {0, 0, 0.5}, {-1.5, 0, 6}, 0.1, 0.05, 6000, 0.003, false, 3);
    strew_cone(set, {5, 0, 0}, {5, 0, 6}, 0.1, 0.05, 6000, 0.003, false, 4);
    const CounterRandom random(8, 8);
    for (std::uint64_t i = 0; i < 10000; ++i)
        set.positions.push_back(
            Vec3(Vec3d{random.uniform(2 * i, -3, 8), random.uniform(2 * i + 1, -4, 4), 0}));
    const PlotSegments segments = segment_plot(set);
    ASSERT_EQ(segments.trees.size(), 2u);
    const auto stems = std::ranges::max(segments.trees, {}, &StemForm::stems).stems;
    EXPECT_EQ(stems, 2u);
}

TEST(Plot, IsIndependentOfTheOrigin) {
    TruePlot plot = make_plot();
    const PlotSegments here = segment_plot(plot.points);
    plot.points.origin = {432'100, 5'712'300, 250};
    const PlotSegments there = segment_plot(plot.points);
    ASSERT_EQ(there.trees.size(), here.trees.size());
    EXPECT_EQ(there.tree_of, here.tree_of);
    for (std::size_t t = 0; t < here.trees.size(); ++t) {
        EXPECT_NEAR(there.trees[t].foot.x - here.trees[t].foot.x, 432'100, 1e-6);
        EXPECT_NEAR(there.trees[t].breast.center.z - here.trees[t].breast.center.z, 250, 1e-6);
    }
}

TEST(Plot, IsBitIdenticalForAnyNumberOfThreads) {
    const TruePlot plot = make_plot();
    const PlotSegments one = segment_plot(plot.points, {}, {.threads = 1, .stop = {}, .progress = {}});
    for (const unsigned threads : {2u, 7u}) {
        const PlotSegments many =
            segment_plot(plot.points, {}, {.threads = threads, .stop = {}, .progress = {}});
        EXPECT_EQ(many.tree_of, one.tree_of);
        ASSERT_EQ(many.trees.size(), one.trees.size());
        for (std::size_t t = 0; t < one.trees.size(); ++t)
            EXPECT_EQ(many.trees[t].breast.diameter, one.trees[t].breast.diameter);
    }
}

TEST(Plot, FindsTreesWithoutGround) {
    TruePlot plot = make_plot();
    PointSet trees{{}, {}};
    for (std::size_t i = 0; i < plot.owner.size(); ++i)
        if (plot.owner[i] < 4) trees.positions.push_back(plot.points.positions[i]);
    const PlotSegments segments = segment_plot(trees);
    EXPECT_FALSE(segments.terrain.is_ground);
    ASSERT_EQ(segments.trees.size(), 4u);
    for (const Standing& tree : kTrees) {
        const std::size_t at = found_at(segments.trees, tree);
        ASSERT_LT(at, 4u);
        const StemForm& form = segments.trees[at];
        const double dbh = 2 * tree.radius * (1 - 0.7 * 1.3 / tree.height);
        EXPECT_NEAR(form.foot.z, slope(tree.x, tree.y), 0.15);
        EXPECT_NEAR(form.breast.diameter, dbh, 0.03 * dbh);
    }
}

TEST(Plot, RejectsInputWithoutAPlot) {
    EXPECT_THROW(segment_plot(PointSet{{{0, 0, 0}}, {}}), InvalidInput);
    const TruePlot plot = make_plot();
    EXPECT_THROW(segment_plot(plot.points, {.min_diameter = 0}), InvalidInput);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(extract_plot(plot.points, {}, {}, {.threads = 2, .stop = stop.get_token(), .progress = {}}),
                 Cancelled);
    PointSet flat;
    for (int i = 0; i < 1000; ++i)
        flat.positions.push_back({0.1f * static_cast<float>(i % 32), 0.1f * static_cast<float>(i), 0});
    EXPECT_TRUE(segment_plot(flat).trees.empty());
    PointSet one_place;
    one_place.positions.assign(1000, {1, 2, 3});
    EXPECT_TRUE(segment_plot(one_place).trees.empty());
}

}  // namespace
}  // namespace coppice
