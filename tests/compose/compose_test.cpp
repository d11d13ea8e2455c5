#include "coppice/compose/compose.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/skeleton/measure.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

namespace coppice {
namespace {

bool same(const Skeleton& a, const Skeleton& b) {
    return std::ranges::equal(a.parents(), b.parents()) && std::ranges::equal(a.positions(), b.positions()) &&
           std::ranges::equal(a.radii(), b.radii());
}

/// Replaces every branch by an equal one, without rotation.
ComposeOptions exact() {
    return {.probability = 1,
            .depth = 1,
            .tolerance = 0.001f,
            .order_tolerance = 0,
            .turn = 0,
            .roll = 0,
            .clearance = 0};
}

/// Counts pairs of segments with an axis distance below the sum of their radii that are not adjacent to a
/// common branch node.
int find_crossings(const Skeleton& s) {
    int count = 0;
    const auto from = [&](NodeId n) { return Vec3d(s.position(s.parent(n))); };
    const auto to = [&](NodeId n) { return Vec3d(s.position(n)); };
    for (const NodeId a : nodes(s)) {
        for (const NodeId b : nodes(s)) {
            if (b <= a || s.is_root(a) || s.is_root(b)) continue;
            if (s.parent(b) == a || s.parent(a) == s.parent(b)) continue;
            const double thick = double{s.radius(s.parent(a))} + double{s.radius(s.parent(b))};
            if (segment_distance(from(a), to(a), from(b), to(b)) > double{s.radius(a)} + double{s.radius(b)})
                continue;
            if (distance(from(a), from(b)) > 4 * thick && distance(to(a), to(b)) > 4 * thick) ++count;
        }
    }
    return count;
}

/// A trunk with one lateral, both of this length.
Skeleton small_tree_of_length(float length) {
    return {{NodeId::none(), NodeId(0), NodeId(1), NodeId(1)},
            {{0, 0, 0}, {0, 0, 1}, {0, 0, 1 + length}, {length, 0, 1}},
            {0.2f, 0.2f, 0.15f, 0.1f}};
}

TEST(Compose, RestoresABranchFromItsOwnTemplate) {
    // A tree with one lateral, thinner than its leader.
    const Skeleton tree{{NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3), NodeId(3)},
                        {{5, 5, 0}, {5.1f, 5, 1}, {5, 5.1f, 2}, {6, 5, 1.4f}, {7, 5.2f, 1.5f}, {6, 6, 1.9f}},
                        {0.2f, 0.2f, 0.15f, 0.1f, 0.08f, 0.05f}};
    auto lateral = child_trees_at(tree, {NodeId(3)});
    const auto [made, report] = TreeComposer(lateral, exact()).compose(tree, 1);
    EXPECT_EQ(report.replaced, 1u);
    ASSERT_EQ(made.size(), tree.size());
    for (const NodeId n : nodes(tree)) {
        const auto here = std::ranges::min_element(made.positions(), {},
                                                   [&](Vec3 p) { return distance(p, tree.position(n)); });
        EXPECT_LT(distance(*here, tree.position(n)), 1e-5f);
    }
}

/// A trunk with a leader and a lateral at z = 1: the leader has the radius of the trunk, the lateral its own,
/// with two segments.
Skeleton trunk_with_lateral(float radius, float lateral_radius, float first, float second) {
    return {{NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3)},
            {{0, 0, 0}, {0, 0, 1}, {0, 0, 3}, {first, 0, 1}, {first + second, 0, 1}},
            {radius, radius, radius, lateral_radius, lateral_radius}};
}

TEST(Compose, BranchesHaveTheGapAndRadiusForTheirLength) {
    const auto lateral = child_trees_at(trunk_with_lateral(0.1f, 0.05f, 0.3f, 1.7f), {NodeId(3)});
    ComposeOptions options = exact();
    options.tolerance = 2;
    const auto tips = [](const Skeleton& s) {
        std::vector<Vec3> out;
        for (const NodeId n : nodes(s)) {
            if (s.position(n).x > 0.01f) out.push_back(s.position(n));
        }
        std::ranges::sort(out, {}, &Vec3::x);
        return out;
    };
    // On a parent branch three times as thick, the first segment is 0.2 m longer, so that 0.2 m are still
    // outside.
    const Skeleton thick =
        TreeComposer(lateral, options).compose(trunk_with_lateral(0.3f, 0.1f, 0.5f, 0.5f), 1).skeleton;
    ASSERT_EQ(tips(thick).size(), 2u);
    EXPECT_NEAR(tips(thick)[0].x, 0.5f, 1e-5f);
    EXPECT_NEAR(tips(thick)[1].x, 2.2f, 1e-5f);
    EXPECT_NEAR(thick.radii().back(), 0.1 * std::pow(2, 0.4), 1e-6);
    // On a thinner one the segment is not shortened.
    const Skeleton thin =
        TreeComposer(lateral, options).compose(trunk_with_lateral(0.05f, 0.02f, 1, 1), 1).skeleton;
    EXPECT_NEAR(tips(thin)[0].x, 0.3f, 1e-5f);
    EXPECT_NEAR(thin.radii().back(), 0.02f, 1e-6);
}

TEST(Compose, DependsOnTheSeedOnly) {
    const Skeleton tree = random_tree(300, 1);
    const TreeComposer composer(child_trees(random_tree(300, 2)), {});
    const ComposeResult a = composer.compose(tree, 5), b = composer.compose(tree, 5),
                        c = composer.compose(tree, 6);
    EXPECT_GT(a.report.replaced, 10u);
    EXPECT_TRUE(same(a.skeleton, b.skeleton));
    EXPECT_FALSE(same(a.skeleton, c.skeleton));
    EXPECT_GT(a.report.depth, 1u);
    EXPECT_LE(a.report.depth, 3u);
}

TEST(Compose, TreeIsUnchangedIfNoBranchIsSelectedOrSimilar) {
    const Skeleton tree = random_tree(300, 1);
    const auto library = child_trees(tree);
    const ComposeResult none = TreeComposer(library, {.probability = 0}).compose(tree, 1);
    EXPECT_TRUE(same(none.skeleton, tree));
    EXPECT_EQ(none.report.chosen, 0u);
    const auto twig = child_trees(small_tree_of_length(1000));
    const ComposeResult unlike = TreeComposer(twig, {}).compose(tree, 1);
    EXPECT_TRUE(same(unlike.skeleton, tree));
    EXPECT_EQ(unlike.report.unmatched, unlike.report.chosen);
}

TEST(Compose, AddsNoIntersections) {
    const Skeleton tree = random_tree(300, 1);
    const TreeComposer composer(child_trees(tree), {.probability = 1, .tries = 4});
    std::uint32_t crossed = 0;
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const auto [made, report] = composer.compose(tree, seed);
        crossed += report.crossed;
        EXPECT_LE(find_crossings(made), find_crossings(tree) + 2) << seed;
    }
    EXPECT_GT(crossed, 0u);
}

TEST(Compose, BranchesRemainInsideACrown) {
    const Skeleton tree = random_tree(300, 1);
    const Box3 box = tree.bounds();
    const SolidField crown(sphere(box.center(), {.radius = 0.35f * box.diagonal()}));
    const ComposeResult made = TreeComposer(child_trees(tree), {.probability = 1}).compose(tree, 3, &crown);
    EXPECT_GT(made.report.outside, 0u);
    std::vector<float> values(1);
    for (const NodeId n : nodes(made.skeleton)) {
        const Vec3 p = made.skeleton.position(n);
        if (std::ranges::find(tree.positions(), p) != tree.positions().end()) continue;
        crown.values({&p, 1}, values);
        EXPECT_GE(values[0], crown.level());
    }
}

TEST(Compose, LateralsAreNotThickerThanTheirParent) {
    const Skeleton tree = random_tree(300, 1);
    for (const ComposeRadii radii : {ComposeRadii::scaled, ComposeRadii::xu}) {
        const auto [made, report] =
            TreeComposer(child_trees(random_tree(400, 9)), {.probability = 1, .tolerance = 1, .radii = radii})
                .compose(tree, 3);
        EXPECT_GT(report.replaced, 10u);
        for (const NodeId n : nodes(made)) {
            if (made.is_root(n)) continue;
            EXPECT_LE(made.radius(n), made.radius(made.parent(n)) * 1.0001f);
        }
    }
}

TEST(Compose, RadiiFollowThePipeModel) {
    const Skeleton tree = random_tree(300, 1);
    const auto made =
        TreeComposer(child_trees(tree), {.radii = ComposeRadii::pipes, .pipe_exponent = 2}).compose(tree, 3);
    for (const NodeId n : nodes(made.skeleton)) {
        double sum = 0;
        for (const NodeId c : made.skeleton.children(n)) sum += std::pow(made.skeleton.radius(c), 2);
        if (made.skeleton.is_tip(n)) continue;
        EXPECT_NEAR(std::sqrt(sum), made.skeleton.radius(n), 1e-4 * made.skeleton.radius(n));
    }
}

TEST(Compose, AcceptsEverySkeletonOfTheZoo) {
    std::vector<ChildTree> library = child_trees(random_tree(200, 4));
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        for (ChildTree& t : child_trees(skeleton)) library.push_back(std::move(t));
    }
    const TreeComposer composer(std::move(library),
                                {.probability = 1, .tolerance = 10, .order_tolerance = 9});
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const ComposeResult made = composer.compose(skeleton, 1);
        EXPECT_EQ(made.skeleton.tree_count(), skeleton.tree_count());
        EXPECT_EQ(made.report.chosen, made.report.replaced + made.report.unmatched + made.report.blocked);
    }
}

TEST(Compose, RejectsInvalidInput) {
    EXPECT_THROW(TreeComposer({}, {}), InvalidInput);
    const auto library = child_trees(random_tree(50, 1));
    EXPECT_THROW(TreeComposer(library, {.probability = 2}), InvalidInput);
    EXPECT_THROW(TreeComposer({ChildTree{Skeleton({NodeId::none()}, {Vec3{}}, {1})}}, {}), InvalidInput);
}

}  // namespace
}  // namespace coppice
