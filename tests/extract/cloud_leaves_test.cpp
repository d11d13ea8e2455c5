#include "coppice/extract/points/leaves_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/points/clean_internal.h"
#include "coppice/extract/points/normal_dispersion_internal.h"
#include "coppice/skeleton/measure.h"
#include "extract/cloud_support.h"

namespace coppice::extract_internal {
namespace {

/// Adds points on a leaf: a flat disc about a position.
void strew_leaf(PointSet& set, Vec3d at, double radius, int count, const CounterRandom& random,
                std::uint64_t& draw) {
    const double up = random.uniform(draw++, -1, 1), turn = random.uniform(draw++, 0, 2 * std::numbers::pi);
    const double flat = std::sqrt(1 - up * up);
    const Vec3d n{flat * std::cos(turn), flat * std::sin(turn), up}, u = perpendicular(n), v = cross(n, u);
    for (int i = 0; i < count; ++i) {
        const double r = radius * std::sqrt(random.uniform(draw++));
        const double angle = random.uniform(draw++, 0, 2 * std::numbers::pi);
        set.positions.push_back(Vec3(at + (std::cos(angle) * u + std::sin(angle) * v) * r));
    }
}

/// A stem of 4 m with twelve branches of 1.2 m, sampled about every 2 cm, and from `leaves_first` on leaves
/// of 7 cm along the outer half of the branches.
struct LeafyTree {
    PointSet set;
    std::size_t leaves_first = 0;
};
LeafyTree leafy_tree(int leaves_per_branch) {
    LeafyTree tree;
    strew_cone(tree.set, {0, 0, 0}, {0, 0, 4}, 0.12, 0.04, 4000, 0.001, false, 1);
    std::vector<Segment> branches;
    for (int k = 0; k < 12; ++k) {
        const double turn = 2.4 * k, z = 1.6 + 0.2 * k;
        const Vec3d a{0, 0, z}, b{1.1 * std::cos(turn), 1.1 * std::sin(turn), z + 0.5};
        strew_cone(tree.set, a, b, 0.03, 0.015, 420, 0.001, false, 2 + static_cast<std::uint64_t>(k));
        branches.push_back({Vec3(a), Vec3(b)});
    }
    tree.leaves_first = tree.set.size();
    const CounterRandom random(17, 3);
    std::uint64_t draw = 0;
    for (const Segment& s : branches) {
        for (int i = 0; i < leaves_per_branch; ++i) {
            const Vec3d at = lerp(Vec3d(s.a), Vec3d(s.b), random.uniform(draw++, 0.5, 1.05));
            const double angle = random.uniform(draw++, 0, 2 * std::numbers::pi);
            const double off = random.uniform(draw++, 0.06, 0.22);
            const Vec3d side = perpendicular(normalized(Vec3d(s.b) - Vec3d(s.a)));
            const Vec3d other = cross(normalized(Vec3d(s.b) - Vec3d(s.a)), side);
            strew_leaf(tree.set, at + (std::cos(angle) * side + std::sin(angle) * other) * off, 0.035, 12,
                       random, draw);
        }
    }
    return tree;
}

struct Found {
    Buffer<Vec3> points;
    std::vector<std::uint8_t> leaf;
};
Found separate_leaves(const PointSet& set, bool always = false, std::uint32_t neighbours = 12,
                      unsigned threads = 0) {
    const Context ctx{.threads = threads};
    Found found{sorted_without_duplicates(set.positions, ctx), {}};
    const Neighbours near = nearest_neighbours(found.points, neighbours, ctx);
    const std::vector<std::uint8_t> none(found.points.size(), 0);
    found.leaf = find_leaves(found.points, near, none, {always, {0.3, 0.3}, {}}, ctx);
    return found;
}

/// Shares of the wood and of the leaves that are classified correctly.
struct Recall {
    double wood = 0, leaves = 0;
};
Recall recall(const LeafyTree& tree, const Found& found) {
    const auto before = [](Vec3 a, Vec3 b) {
        return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
    };
    std::vector<Vec3> leaves(tree.set.positions.begin() + static_cast<std::ptrdiff_t>(tree.leaves_first),
                             tree.set.positions.end());
    std::ranges::sort(leaves, before);
    double wood = 0, kept = 0, right = 0;
    for (std::size_t i = 0; i < found.points.size(); ++i) {
        if (std::ranges::binary_search(leaves, found.points[i], before)) {
            right += found.leaf[i];
        } else {
            ++wood;
            kept += !found.leaf[i];
        }
    }
    return {kept / wood, right / static_cast<double>(leaves.size())};
}

NormalDispersion compute_dispersion(const PointSet& set) {
    const Buffer<Vec3> points = sorted_without_duplicates(set.positions, {});
    return normal_dispersion(points, nearest_neighbours(points, 12, {}), {});
}

TEST(NormalDispersion, IsNearZeroOnPlanesAndTubesOfAnyThickness) {
    PointSet plane, tubes;
    const CounterRandom random(3, 1);
    for (std::uint64_t i = 0; i < 4000; ++i) {
        const double x = random.uniform(2 * i), y = random.uniform(2 * i + 1);
        plane.positions.push_back(Vec3(Vec3d{x, y, 0.5 * x}));
    }
    EXPECT_LT(std::ranges::max(compute_dispersion(plane).value), 1e-5);
    // Normals tilt near the rims; about four fifths of the points are not within a few spacings of a rim.
    strew_cone(tubes, {0, 0, 0}, {0, 0, 4}, 0.1, 0.1, 8000, 0, false, 1);
    strew_cone(tubes, {3, 0, 0}, {3, 0, 4}, 0.3, 0.2, 8000, 0, false, 2);
    const NormalDispersion d = compute_dispersion(tubes);
    EXPECT_LT(d.share, 0.001);
    EXPECT_GE(std::ranges::count_if(d.value, [](float v) { return v < 0.02f; }), 15000);
}

TEST(NormalDispersion, IsAThirdForRandomNormals) {
    PointSet leaves;
    const CounterRandom random(5, 1);
    std::uint64_t draw = 0;
    for (int i = 0; i < 3000; ++i) {
        const Vec3d at{random.uniform(draw), random.uniform(draw + 1), random.uniform(draw + 2)};
        draw += 3;
        strew_leaf(leaves, at, 0.04, 5, random, draw);
    }
    const NormalDispersion d = compute_dispersion(leaves);
    EXPECT_GT(d.share, 0.9);
    EXPECT_LE(std::ranges::max(d.value), 1.0f / 3 + 1e-6f);
    EXPECT_GT(std::ranges::max(d.value), 0.27f);
}

TEST(NormalDispersion, IsZeroForTwoPoints) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}};
    EXPECT_LT(std::ranges::max(normal_dispersion(points, nearest_neighbours(points, 12, {}), {}).value),
              1e-6f);
}

TEST(VoxelGrid, ContainsTheMeanPointOfEachVoxel) {
    const PointSet set = fork_cloud();
    const Buffer<Vec3> points = sorted_without_duplicates(set.positions, {});
    const Box3 box = bounds(set);
    const VoxelGrid voxels = voxel_grid(points, 0.1, {});
    std::map<std::array<int, 3>, std::vector<std::size_t>> cubes;
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::array<int, 3> cube{};
        for (int axis = 0; axis < 3; ++axis)
            cube[static_cast<std::size_t>(axis)] =
                static_cast<int>((double{points[i][axis]} - double{box.low[axis]}) / 0.1);
        cubes[cube].push_back(i);
    }
    ASSERT_EQ(voxels.centroid.size(), cubes.size());
    ASSERT_EQ(voxels.of_point.size(), points.size());
    for (const auto& [cube, members] : cubes) {
        Vec3d sum;
        for (const std::size_t i : members) {
            EXPECT_EQ(voxels.of_point[i], voxels.of_point[members[0]]);
            sum += Vec3d(points[i]);
        }
        const Vec3d mean = sum / static_cast<double>(members.size());
        EXPECT_LT(distance(mean, Vec3d(voxels.centroid[voxels.of_point[members[0]]])), 1e-6);
    }
    EXPECT_EQ(voxel_grid(points, 100, {}).centroid.size(), 1u);
}

TEST(CloudLeaves, MarkNoWoodOfTreesWithoutLeaves) {
    for (const PointSet& set : {fork_cloud(), fork_cloud(0.004), fork_cloud(0.05), leafy_tree(0).set}) {
        EXPECT_EQ(std::ranges::count(separate_leaves(set).leaf, 1), 0);
    }
}

TEST(CloudLeaves, AreDistinguishedFromWood) {
    const LeafyTree tree = leafy_tree(100);
    const Found found = separate_leaves(tree.set);
    const Recall r = recall(tree, found);
    EXPECT_GT(r.wood, 0.8);
    EXPECT_GT(r.leaves, 0.9);
    // Below its branches, the stem is farthest from leaves.
    for (std::size_t i = 0; i < found.points.size(); ++i) {
        ASSERT_FALSE(found.leaf[i] && found.points[i].z < 1.2f) << found.points[i].z;
    }
}

TEST(CloudLeaves, AreFoundAtAnyDensity) {
    // The same tree with each point eight times, with offsets of 3 mm: leaves of 96 points, smooth relative
    // to their neighbours.
    const LeafyTree tree = leafy_tree(100);
    LeafyTree dense;
    const CounterRandom random(23, 1);
    for (std::size_t i = 0; i < tree.set.size(); ++i) {
        if (i == tree.leaves_first) dense.leaves_first = dense.set.size();
        for (std::uint64_t k = 0; k < 8; ++k) {
            const std::uint64_t draw = 24 * i + 3 * k;
            const Vec3d off{random.uniform(draw, -0.003, 0.003), random.uniform(draw + 1, -0.003, 0.003),
                            random.uniform(draw + 2, -0.003, 0.003)};
            dense.set.positions.push_back(Vec3(Vec3d(tree.set.positions[i]) + off));
        }
    }
    const Recall r = recall(dense, separate_leaves(dense.set));
    EXPECT_GT(r.wood, 0.8);
    EXPECT_GT(r.leaves, 0.75);
}

TEST(CloudLeaves, IgnoreTheNumberOfNeighboursBelowTwelve) {
    const PointSet set = leafy_tree(100).set;
    const auto leaf = separate_leaves(set).leaf;
    EXPECT_EQ(separate_leaves(set, false, 4).leaf, leaf);
    EXPECT_EQ(separate_leaves(set, false, 8).leaf, leaf);
}

TEST(CloudLeaves, ExcludeIgnoredPoints) {
    const Buffer<Vec3> points = sorted_without_duplicates(leafy_tree(100).set.positions, {});
    std::vector<std::uint8_t> ignored(points.size(), 0);
    for (std::size_t i = 0; i < ignored.size(); i += 7) ignored[i] = 1;
    const auto leaf =
        find_leaves(points, nearest_neighbours(points, 12, {}), ignored, {false, {0.3, 0.3}, {}}, {});
    EXPECT_GT(std::ranges::count(leaf, 1), 3000);
    for (std::size_t i = 0; i < ignored.size(); i += 7) EXPECT_EQ(leaf[i], 0);
}

TEST(CloudLeaves, AreBitIdenticalForAnyNumberOfThreads) {
    const PointSet set = leafy_tree(100).set;
    const auto one = separate_leaves(set, false, 12, 1).leaf;
    for (const unsigned threads : {2u, 7u}) EXPECT_EQ(separate_leaves(set, false, 12, threads).leaf, one);
}

TEST(CloudLeaves, RuleSelectsThePointsToExclude) {
    const LeafyTree tree = leafy_tree(100);
    const CloudExtraction kept = extract_from_cloud(tree.set, {.leaves = LeafRule::keep});
    const CloudExtraction separated = extract_from_cloud(tree.set, {.detail = 1});
    EXPECT_EQ(kept.cleaning.leaves, 0u);
    EXPECT_GT(separated.cleaning.leaves, 0.8 * static_cast<double>(tree.set.size() - tree.leaves_first));
    // 4 m of stem and 12 branches of sqrt(1.1^2 + 0.5^2) = 1.21 m: 18.5 m of wood.
    const double length = measure(separated.skeleton).length;
    EXPECT_NEAR(length, 18.5, 6);
    EXPECT_GT(measure(kept.skeleton).length, 1.5 * length);
    // Finer detail adds more twigs to clusters of leaves.
    const double coarse = measure(extract_from_cloud(tree.set, {.detail = 0.2f}).skeleton).length;
    const double fine = measure(extract_from_cloud(tree.set, {.detail = 0.1f}).skeleton).length;
    EXPECT_LT(length, coarse);
    EXPECT_LT(coarse, fine);
    EXPECT_LT(fine, measure(kept.skeleton).length);

    const PointSet bare = leafy_tree(0).set;
    const CloudExtraction all = extract_from_cloud(bare, {.leaves = LeafRule::keep});
    const CloudExtraction automatic = extract_from_cloud(bare);
    EXPECT_EQ(automatic.cleaning.leaves, 0u);
    EXPECT_TRUE(std::ranges::equal(all.skeleton.positions(), automatic.skeleton.positions()));
    EXPECT_GT(extract_from_cloud(bare, {.leaves = LeafRule::drop}).cleaning.leaves, 0u);
}

}  // namespace
}  // namespace coppice::extract_internal
