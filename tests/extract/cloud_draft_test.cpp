#include "coppice/extract/cloud/initial_tree_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/extract/cloud/centerline_internal.h"
#include "coppice/extract/points/clean_internal.h"
#include "extract/cloud_support.h"

namespace coppice::extract_internal {
namespace {

/// Cloud with the input of the steps of the initial tree.
struct Prepared {
    Buffer<Vec3> points;
    Graph graph;
    Buffer<float> spacing;
    FitSamples samples;
    explicit Prepared(const PointSet& set) : points(set.positions.begin(), set.positions.end()) {
        const Neighbours near = nearest_neighbours(points, 12, {});
        graph = make_graph(near, std::vector<std::uint8_t>(points.size(), 0), {}, {});
        spacing = local_spacing(near, 4);
        samples = {points, {}, std::vector<std::uint32_t>(points.size(), kNoIndex)};
    }
    CloudInput cloud(StemBases bases = {}) const { return {graph, bases, spacing, {}, {}}; }
};

/// Returns a stem of radius 0.1 up to a height of 2, as one segment.
InitialTree stem() {
    InitialTree tree;
    tree.add(kNoIndex, {0, 0, 0}, 0.1);
    tree.add(0, {0, 0, 2}, 0.1);
    return tree;
}

TEST(CloudAssignment, PointsBelongToTheSurfaceTheyAreOn) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 2}, 0.1, 0.1, 3000, 0.002);
    const std::size_t on = set.size();
    // Farther from the surface than the noise, a fifth of the radius or a third of a spacing of some 20 mm.
    for (int i = 0; i < 40; ++i) set.positions.push_back({0.135f, 0, 0.5f + 0.02f * static_cast<float>(i)});
    Prepared p(set);
    const PointDistances distances = assign_points(stem(), p.samples, p.spacing, {});
    EXPECT_EQ(std::ranges::count(p.samples.node, kNoIndex), 40);
    EXPECT_EQ(
        std::count(p.samples.node.begin() + static_cast<std::ptrdiff_t>(on), p.samples.node.end(), kNoIndex),
        40);
    EXPECT_NEAR(distances.distance[on], 0.035, 1e-5);
    // The sum of three uniform numbers of 2 mm each has a standard deviation of 1 mm.
    EXPECT_NEAR(distances.noise, 0.001, 0.0002);
}

TEST(CloudAssignment, RemovesTheSecondOfTwoAxesAndPreservesSeparateOnes) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 2}, 0.1, 0.1, 3000, 0.002);
    strew_cone(set, {0.1, 0, 1}, {0.5, 0, 1.2}, 0.03, 0.03, 400, 0.002);
    Prepared p(set);
    InitialTree tree = stem();
    const std::uint32_t fork = tree.add(0, {0, 0, 0.95}, 0.1);
    tree.parent[1] = fork;
    tree.add(fork, {0.5, 0, 1.2}, 0.03);       // the branch
    tree.add(fork, {0.08, 0.02, 1.6}, 0.015);  // a second axis along the bark
    const auto new_of_old = sort_parents_first(tree);
    EXPECT_EQ(new_of_old.size(), 5u);
    const PointDistances distances = assign_points(tree, p.samples, p.spacing, {});
    EXPECT_EQ(prune_redundant(tree, p.samples, p.spacing, distances.noise, {}), 1u);
    ASSERT_EQ(tree.size(), 4u);
    EXPECT_EQ(std::ranges::count_if(tree.position, [](Vec3d q) { return q.x > 0.4; }), 1);
    // No other branch explains the remaining points.
    EXPECT_EQ(prune_redundant(tree, p.samples, p.spacing, distances.noise, {}), 0u);
}

TEST(CloudAssignment, RemovesABranchWithoutPointsWithoutDividingByZero) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 2}, 0.1, 0.1, 3000, 0.002);
    Prepared p(set);
    InitialTree tree = stem();
    tree.add(tree.add(kNoIndex, {3, 0, 0}, 0.03), {3, 0, 5}, 0.03);
    std::feclearexcept(FE_ALL_EXCEPT);
    EXPECT_EQ(prune_redundant(tree, p.samples, p.spacing, 0.001, {.threads = 1}), 1u);
    EXPECT_FALSE(std::fetestexcept(FE_INVALID | FE_DIVBYZERO));
}

TEST(CloudChains, FollowATwigOfTenPointsToTheStem) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 2}, 0.1, 0.1, 3000);
    strew_cone(set, {0.1, 0, 1}, {0.4, 0, 1}, 0.01, 0.01, 10);
    Prepared p(set);
    InitialTree tree = stem();
    const PointDistances distances = assign_points(tree, p.samples, p.spacing, {});
    grow_chains(tree, p.samples, p.cloud(), distances, {});
    ASSERT_GT(tree.size(), 2u);
    const InitialTreeLinks links(tree);
    int tips = 0;
    for (std::uint32_t n = 2; n < tree.size(); ++n) {
        tips += links.is_tip(n) ? 1 : 0;
        EXPECT_LT(std::hypot(tree.position[n].y, tree.position[n].z - 1), 0.015) << n;
        EXPECT_LE(tree.radius[n], 0.02) << n;
    }
    EXPECT_EQ(tips, 1);
    EXPECT_NEAR(tree.position.back().x, 0.4, 0.07);
}

TEST(CloudAttach, AttachesLooseTubesToEachOtherAndToTheRoot) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 2}, 0.1, 0.1, 6000);
    Prepared p(set);
    InitialTree tree;  // two tubes with half a metre between them, the upper one reversed
    tree.add(kNoIndex, {0, 0, 0.1}, 0.1);
    tree.add(0, {0, 0, 0.7}, 0.1);
    tree.add(kNoIndex, {0, 0, 1.9}, 0.1);
    tree.add(2, {0, 0, 1.2}, 0.1);
    assign_points(tree, p.samples, p.spacing, {});
    std::vector<std::vector<std::uint32_t>> bases(1);
    for (std::uint32_t i = 0; i < p.points.size(); ++i)
        if (p.points[i].z < 0.03f) bases[0].push_back(i);
    EXPECT_EQ(attach_tubes(tree, p.samples, p.cloud(bases), {}, true, {}), p.points.size());
    EXPECT_EQ(std::ranges::count(tree.parent, kNoIndex), 1);
    const auto top = std::ranges::max_element(tree.position, {}, &Vec3d::z) - tree.position.begin();
    EXPECT_TRUE(InitialTreeLinks(tree).is_tip(static_cast<std::uint32_t>(top)));
    EXPECT_DOUBLE_EQ(tree.position[static_cast<std::size_t>(top)].z, 1.9);
    EXPECT_LT(tree.position[0].z, 0.03);
}

TEST(CloudLaterals, LateralsStartWhereTheirAxesMeet) {
    InitialTree tree = stem();
    tree.position[1].z = 4;
    const std::uint32_t fork = tree.add(0, {0, 0, 1.4}, 0.1);  // too high
    tree.parent[1] = fork;
    const std::uint32_t inside = tree.add(fork, {0.03, 0, 1.3}, 0.02);
    const std::uint32_t outside = tree.add(inside, {0.3, 0, 1.3}, 0.02);
    tree.add(outside, {0.6, 0, 1.6}, 0.02);
    FitSamples samples;
    samples.node = {inside};
    const auto new_of_old = sort_parents_first(tree);
    samples.node[0] = new_of_old[inside];
    reattach_laterals(tree, samples, {});
    // At 45 degrees, starting at 0.3 from the axis of the stem at a height of 1.3: it leaves the stem at 1.0.
    const auto lateral = std::ranges::find(tree.position, Vec3d(0.3, 0, 1.3)) - tree.position.begin();
    ASSERT_LT(lateral, tree.size());
    const Vec3d start = tree.position[tree.parent[static_cast<std::size_t>(lateral)]];
    EXPECT_DOUBLE_EQ(start.x, 0);
    EXPECT_NEAR(start.z, 1.0, 0.1);
    EXPECT_EQ(samples.node[0], static_cast<std::uint32_t>(lateral));
    EXPECT_EQ(std::ranges::count(tree.position, Vec3d(0.03, 0, 1.3)), 0);
}

TEST(CloudLaterals, ALateralOfOneSegmentKeepsItsDirection) {
    InitialTree tree = stem();
    tree.position[1].z = 4;
    const std::uint32_t fork = tree.add(0, {0, 0, 1.4}, 0.1);
    tree.parent[1] = fork;
    const std::uint32_t inside = tree.add(fork, {0.05, 0, 1.05}, 0.02);
    tree.add(inside, {1, 0, 2}, 0.02);
    FitSamples samples;
    sort_parents_first(tree);
    reattach_laterals(tree, samples, {});
    const auto tip = std::ranges::find(tree.position, Vec3d(1, 0, 2)) - tree.position.begin();
    ASSERT_LT(tip, tree.size());
    const Vec3d start = tree.position[tree.parent[static_cast<std::size_t>(tip)]];
    EXPECT_DOUBLE_EQ(start.x, 0);
    EXPECT_NEAR(start.z, 1.0, 0.15);  // at 45 degrees; the place on the stem closest to the tip is at 2
}

TEST(CloudCenterline, WidensToAWholeTubeButNotToItsNeighbour) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 1}, 0.05, 0.05, 600);
    strew_cone(set, {0.3, 0, 0}, {0.3, 0, 1}, 0.05, 0.05, 600, 0, false, 2);
    Prepared p(set);
    std::vector<std::uint32_t> base;
    for (std::uint32_t i = 0; i < 600; ++i) {
        if (p.points[i].z >= 0.02f) continue;
        base.push_back(i);
        p.samples.node[i] = 0;
    }
    const Paths paths = shortest_paths(p.graph, base, p.samples.node, {p.spacing}, {});
    BranchPoints points{p.points, p.graph, p.spacing, p.samples.node, 1};
    Centerline branch;
    trace_path(branch, points, paths.order.back(), paths);
    fit_centerline(branch, points, 0.1);
    EXPECT_GT(branch.members.size(), 540u);
    for (const BranchPoint& m : branch.members) EXPECT_LT(m.point, 600u);
}

TEST(FittedTree, LimitsTheRadiiOfShortThickSections) {
    InitialTree tree;
    tree.add(kNoIndex, {0, 0, 0}, 0.1);
    for (std::uint32_t i = 1; i <= 10; ++i) tree.add(i - 1, {0, 0, 0.1 * i}, 0.01);
    tree.radius[8] = 0.05;    // 0.1 m long, less than the maximum of 0.6 m
    tree.radius[10] = 0.022;  // 2.2 times as thick
    correct_swollen_radii(tree);
    EXPECT_EQ(tree.radius[8], 0.01);
    EXPECT_EQ(tree.radius[10], 0.022);
    // A longer thick section is a branch, as is one at the root or beyond a thin section.
    for (std::uint32_t i = 7; i <= 10; ++i) tree.radius[i] = 0.03;
    tree.radius[2] = 0.002;
    const auto before = tree.radius;
    correct_swollen_radii(tree);
    EXPECT_EQ(tree.radius, before);
}

TEST(CloudAttach, RemovesShortTubesMuchThickerThanTheirParent) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 2}, 0.1, 0.1, 3000);
    strew_cone(set, {0.1, 0, 1}, {0.5, 0, 1}, 0.01, 0.01, 200);
    const std::size_t first = set.size();
    strew_cone(set, {0.5, 0, 1}, {0.7, 0, 1}, 0.06, 0.06, 100);
    Prepared p(set);
    std::vector<std::uint32_t> base;
    for (std::uint32_t i = 0; i < 3000; ++i) {
        if (p.points[i].z < 0.05f) base.push_back(i);
        p.samples.node[i] = 1;
    }
    const std::vector<std::vector<std::uint32_t>> bases{base};
    for (const double end : {0.7, 1.5}) {
        Prepared q = p;
        InitialTree tree = stem();
        tree.add(kNoIndex, {0.1, 0, 1}, 0.01);
        tree.add(2, {0.5, 0, 1}, 0.01);
        tree.add(kNoIndex, {0.5, 0, 1}, 0.06);
        tree.add(4, {end, 0, 1}, 0.06);  // 3 radii long, then 17
        for (std::size_t i = 3000; i < first; ++i) q.samples.node[i] = 3;
        for (std::size_t i = first; i < q.points.size(); ++i) q.samples.node[i] = 5;
        attach_tubes(tree, q.samples, q.cloud(bases), {}, true, {});
        const bool kept = end > 1;
        EXPECT_EQ(std::ranges::count(tree.radius, 0.06), kept ? 2 : 0);
        EXPECT_EQ(q.samples.node.back() == kNoIndex, !kept);
    }
}

}  // namespace
}  // namespace coppice::extract_internal
