#include "coppice/foliage/tree_foliage.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "foliage/shoots.h"

namespace coppice {
namespace {

const BranchletOptions kBranchlets{.length = 0.2f, .laterals = 3, .spacing = 0.1f};

LeafRules make_rules() { return {.max_radius = 0.004f, .shoot_length = 0.5f}; }

TEST(TreeFoliage, without_branchlets_are_leaves_on_shoots) {
    const Skeleton tree = test::make_shoot_tree(20).make();
    const TreeFoliage made = make_foliage(tree, {}, make_rules(), {}, 3);
    EXPECT_EQ(made.branchlets, 0u);
    EXPECT_EQ(made.prototypes.size(), 3u);
    EXPECT_EQ(made.foliage.report.leaves, made.foliage.instances.size());
}

TEST(TreeFoliage, branchlets_are_a_twig_and_its_leaves_at_one_place) {
    const Skeleton tree = test::make_shoot_tree(20).make();
    const TreeFoliage made = make_foliage(tree, {}, make_rules(), kBranchlets, 2);
    validate(made.prototypes, made.foliage.instances);
    const Instances& copies = made.foliage.instances;
    ASSERT_GT(made.branchlets, 50u);
    ASSERT_EQ(copies.size(), 2 * made.branchlets);
    for (std::size_t i = 0; i < copies.size(); i += 2) {
        EXPECT_EQ(made.prototypes[copies.prototypes[i]].material, kLeafMaterial);
        EXPECT_EQ(made.prototypes[copies.prototypes[i + 1]].material, kTwigMaterial);
        EXPECT_EQ(copies.positions[i], copies.positions[i + 1]);
    }
    EXPECT_GT(made.foliage.report.leaves, 5 * made.branchlets);
    std::set<std::string> names;
    for (const Prototype& p : made.prototypes) names.insert(p.name);
    EXPECT_EQ(names.size(), made.prototypes.size());
}

/// The area of the report is the sum of the triangles of flat leaves, without those of petioles.
TEST(TreeFoliage, leaf_area_is_that_of_the_triangles) {
    const Skeleton tree = test::make_shoot_tree(10).make();
    const LeafShape flat{.fold = 0, .cup = 0, .curl = 0, .petiole_length = 0, .blade_angle = 0};
    const TreeFoliage made = make_foliage(tree, flat, make_rules(), kBranchlets, 2);
    double area = 0;
    const Instances& copies = made.foliage.instances;
    for (std::size_t i = 0; i < copies.size(); ++i) {
        const Prototype& p = made.prototypes[copies.prototypes[i]];
        if (p.material != kLeafMaterial) continue;
        for (const Triangle& t : p.mesh.triangles) {
            const Vec3 a = copies.place(i, p.mesh.positions[t[0]]);
            area += 0.5 * double{length(cross(copies.place(i, p.mesh.positions[t[1]]) - a,
                                              copies.place(i, p.mesh.positions[t[2]]) - a))};
        }
    }
    EXPECT_NEAR(area, made.foliage.report.leaf_area, 0.01 * area);
}

TEST(TreeFoliage, seasons_change_leaves_but_not_twigs) {
    const Skeleton tree = test::make_shoot_tree(10).make();
    LeafRules rules = make_rules();
    const TreeFoliage summer = make_foliage(tree, {}, rules, kBranchlets, 2);
    rules.season = Season::winter;
    const TreeFoliage winter = make_foliage(tree, {}, rules, kBranchlets, 2);
    EXPECT_EQ(winter.branchlets, summer.branchlets);
    EXPECT_EQ(winter.foliage.report.leaves, 0u);
    validate(winter.prototypes, winter.foliage.instances);
    rules.season = Season::autumn;
    const TreeFoliage autumn = make_foliage(tree, {}, rules, kBranchlets, 2);
    EXPECT_LT(autumn.foliage.report.leaves, summer.foliage.report.leaves);
    EXPECT_NE(autumn.foliage.instances.colors, summer.foliage.instances.colors);
}

TEST(TreeFoliage, maximum_index_keeps_the_same_branchlets_in_all_seasons) {
    const Skeleton tree = test::make_shoot_tree(60).make();
    LeafRules rules = make_rules();
    const TreeFoliage all = make_foliage(tree, {}, rules, kBranchlets, 2);
    rules.max_index = static_cast<float>(0.6 * all.foliage.report.leaf_area_index);
    const TreeFoliage summer = make_foliage(tree, {}, rules, kBranchlets, 2);
    EXPECT_LE(summer.foliage.report.leaf_area_index, 1.03 * double{rules.max_index});
    EXPECT_GE(summer.foliage.report.leaf_area_index, 0.85 * double{rules.max_index});
    EXPECT_LT(summer.branchlets, all.branchlets);
    rules.season = Season::winter;
    EXPECT_EQ(make_foliage(tree, {}, rules, kBranchlets, 2).branchlets, summer.branchlets);
}

TEST(TreeFoliage, ThreadsGiveTheSameBits) {
    const Skeleton tree = test::make_shoot_tree(40).make();
    const TreeFoliage one = make_foliage(tree, {}, make_rules(), kBranchlets, 3, {}, {.threads = 1});
    const TreeFoliage four = make_foliage(tree, {}, make_rules(), kBranchlets, 3, {}, {.threads = 4});
    EXPECT_EQ(one.foliage.instances.positions, four.foliage.instances.positions);
    EXPECT_EQ(one.foliage.instances.colors, four.foliage.instances.colors);
    EXPECT_EQ(one.foliage.report.leaves, four.foliage.report.leaves);
}

}  // namespace
}  // namespace coppice
