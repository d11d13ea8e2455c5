#include "coppice/foliage/placement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/skeleton/segment_cone.h"
#include "described_options.h"
#include "errors.h"
#include "foliage/shoots.h"
#include "zoo.h"

namespace coppice {
namespace {

using test::error_of;

std::vector<LeafModel> make_models() { return make_leaves({}, 3); }

/// Returns a level shoot along x of 30 cm and radius 2 mm, which begins at the root.
Skeleton make_level_shoot() {
    test::ShootTree tree;
    const NodeId root = tree.add({}, {0, 0, 1}, 0.002f);
    tree.add_shoot(root, {1, 0, 0}, 0.3f, 0.002f);
    return tree.make();
}

/// Rules without random deviations, on stems too.
LeafRules make_exact() {
    return {.max_radius = 0.004f,
            .min_order = 0,
            .internode = 0.031f,
            .light = 0,
            .droop = 0,
            .spread = 0,
            .size_spread = 0};
}

/// Returns the distance of a point from the union of the cones of all segments; negative inside.
double compute_distance(const Skeleton& skeleton, Vec3 p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const NodeId n : nodes(skeleton)) {
        if (skeleton.is_root(n)) continue;
        const RoundCone cone = round_cone(skeleton.segment(n));
        nearest = std::min(nearest, cone.closest_point(Vec3d(p)).signed_distance());
    }
    return nearest;
}

TEST(Placement, describes_all_members) {
    test::expect_described<LeafRules>(7);  // after the bool, before the first colour and at the end
}

/// 0.3 m with nodes every 0.031 m: one at the tip and 9 more.
TEST(Placement, every_node_has_its_leaves) {
    LeafRules rules = make_exact();
    const Skeleton shoot = make_level_shoot();
    EXPECT_EQ(place_leaves(shoot, make_models(), rules).report.leaves, 10u);
    rules.arrangement = LeafArrangement::opposite;
    EXPECT_EQ(place_leaves(shoot, make_models(), rules).report.leaves, 20u);
    rules.arrangement = LeafArrangement::whorled;
    rules.whorl = 4;
    EXPECT_EQ(place_leaves(shoot, make_models(), rules).report.leaves, 40u);
    rules.shoot_length = 0.1f;  // the tip and three more
    EXPECT_EQ(place_leaves(shoot, make_models(), rules).report.leaves, 16u);
}

TEST(Placement, begins_on_the_bark_and_leaves_at_the_angle) {
    const LeafRules rules = make_exact();
    const Instances leaves = place_leaves(make_level_shoot(), make_models(), rules).instances;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        const Vec3 p = leaves.positions[i];
        EXPECT_NEAR(std::hypot(p.y, p.z - 1), 0.002, 1e-6);
        EXPECT_NEAR(p.x, 0.3 - 0.031 * static_cast<double>(i), 1e-5);
        const Vec3 along = rotate(leaves.rotations[i], {0, 1, 0}),
                   up = rotate(leaves.rotations[i], {0, 0, 1});
        // Leaves at the tip have opened less.
        if (i >= 3) {
            EXPECT_NEAR(along.x, std::cos(0.9), 1e-5);
        }
        // The petiole points away from the axis, and the upper side faces the tip of the shoot.
        EXPECT_GT(along.y * p.y + along.z * (p.z - 1), 0);
        EXPECT_GT(up.x, 0);
        EXPECT_NEAR(length(along), 1, 1e-5);
    }
}

TEST(Placement, spiral_turns_by_the_divergence) {
    LeafRules rules = make_exact();
    rules.divergence = 2.0f;
    const Instances leaves = place_leaves(make_level_shoot(), make_models(), rules).instances;
    for (std::size_t i = 1; i < leaves.size(); ++i) {
        const Vec3 a = leaves.positions[i - 1], b = leaves.positions[i];
        const double cosine = (double{a.y} * double{b.y} + (double{a.z} - 1) * (double{b.z} - 1)) / 4e-6;
        EXPECT_NEAR(cosine, std::cos(2.0), 2e-3);
    }
}

TEST(Placement, two_ranks_are_level_on_level_shoots) {
    LeafRules rules = make_exact();
    rules.arrangement = LeafArrangement::two_ranked;
    rules.light = 1;
    const Instances leaves = place_leaves(make_level_shoot(), make_models(), rules).instances;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        EXPECT_NEAR(leaves.positions[i].z, 1, 1e-6);
        EXPECT_NEAR(rotate(leaves.rotations[i], {0, 0, 1}).z, 1, 1e-5);
        if (i > 0) {
            EXPECT_LT(leaves.positions[i].y * leaves.positions[i - 1].y, 0);
        }
    }
}

TEST(Placement, droop_turns_leaves_down) {
    LeafRules rules = make_exact();
    rules.light = 1;
    rules.droop = 0.5f;
    const Instances leaves = place_leaves(make_level_shoot(), make_models(), rules).instances;
    for (const auto& r : leaves.rotations) EXPECT_NEAR(rotate(r, {0, 1, 0}).z, -std::sin(0.5), 1e-4);
}

TEST(Placement, clustering_moves_leaves_to_the_tip) {
    LeafRules rules = make_exact();
    const auto mean_x = [&] {
        const Instances leaves = place_leaves(make_level_shoot(), make_models(), rules).instances;
        double sum = 0;
        for (const Vec3 p : leaves.positions) sum += p.x;
        return sum / static_cast<double>(leaves.size());
    };
    const double even = mean_x();
    rules.clustering = 1;
    EXPECT_GT(mean_x(), even + 0.05);
}

/// On every skeleton: no leaf is off the bark, and none has its tip in wood.
TEST(Placement, leaves_are_on_the_bark_and_outside_of_wood) {
    std::uint64_t leaves_of_all = 0;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        if (skeleton.size() > 2000) continue;
        const std::vector<LeafModel> models{make_leaf_card({})};
        const Foliage foliage =
            place_leaves(skeleton, models, {.shoot_length = 0.5f, .min_order = 0, .internode = 0.05f});
        leaves_of_all += foliage.report.leaves;
        EXPECT_EQ(foliage.report.floating, 0u) << name;
        const float size = skeleton.bounds().diagonal();
        for (std::size_t i = 0; i < std::min<std::size_t>(foliage.instances.size(), 200); ++i)
            EXPECT_LT(compute_distance(skeleton, foliage.instances.positions[i]), 1e-4 + 1e-6 * double{size})
                << name;
    }
    EXPECT_GT(leaves_of_all, 100u);
}

TEST(Placement, removes_leaves_inside_of_wood) {
    test::ShootTree tree = test::make_shoot_tree(10);
    const std::vector<LeafModel> models{make_leaf_card({})};
    const LeafRules rules{.max_radius = 0.004f, .shoot_length = 2, .internode = 0.01f};
    const Skeleton skeleton = tree.make();
    const Foliage foliage = place_leaves(skeleton, models, rules);
    EXPECT_GT(foliage.report.inside_wood, 20u);
    const Vec3 tip = models[0].prototype.mesh.positions[2];
    for (std::size_t i = 0; i < foliage.instances.size(); ++i) {
        const Vec3 p = foliage.instances.positions[i];
        EXPECT_GT(std::hypot(p.x, p.y), 0.045f);  // the trunk has a radius of 5 cm
        const Vec3 end = p + rotate(foliage.instances.rotations[i], foliage.instances.scales[i] * tip);
        EXPECT_FALSE(std::hypot(end.x, end.y) < 0.05f && end.z > 0 && end.z < 1);
    }
}

TEST(Placement, leaves_of_an_axis_do_not_depend_on_other_axes) {
    const test::ShootTree tree = test::make_shoot_tree(10);
    test::ShootTree fewer = tree;
    const std::size_t kept = fewer.parent.size() - 13;  // without the last shoot and the end of the trunk
    fewer.parent.resize(kept);
    fewer.position.resize(kept);
    fewer.radius.resize(kept);
    fewer.ids.resize(kept);
    const LeafRules rules{.max_radius = 0.004f};
    const Instances all = place_leaves(tree.make(), make_models(), rules).instances;
    const Instances some = place_leaves(fewer.make(), make_models(), rules).instances;
    ASSERT_LT(some.size(), all.size());
    ASSERT_GT(some.size(), 50u);
    for (const Vec3 p : some.positions)
        EXPECT_TRUE(std::ranges::find(all.positions, p) != all.positions.end());
}

TEST(PlacementThreads, same_bits_for_any_number_of_threads) {
    const Skeleton skeleton = test::make_shoot_tree(300).make();
    const LeafRules rules{.max_radius = 0.004f, .internode = 0.005f};
    const Foliage one = place_leaves(skeleton, make_models(), rules, {.threads = 1});
    for (const unsigned threads : {2u, 5u}) {
        const Foliage many = place_leaves(skeleton, make_models(), rules, {.threads = threads});
        EXPECT_EQ(one.instances.positions, many.instances.positions);
        EXPECT_EQ(one.instances.prototypes, many.instances.prototypes);
        EXPECT_EQ(one.instances.scales, many.instances.scales);
        EXPECT_EQ(one.instances.colors, many.instances.colors);
        EXPECT_EQ(one.report.leaf_area, many.report.leaf_area);
        EXPECT_EQ(one.report.crown_area, many.report.crown_area);
    }
}

TEST(Placement, seasons_differ) {
    const Skeleton skeleton = test::make_shoot_tree(50).make();
    LeafRules rules{.max_radius = 0.004f};
    const auto place = [&](Season season) {
        rules.season = season;
        return place_leaves(skeleton, make_models(), rules);
    };
    const Foliage summer = place(Season::summer);
    EXPECT_EQ(place(Season::winter).report.leaves, 0u);
    // Lengths of 0.25 and 0.7: areas of a sixteenth and of 0.49.
    EXPECT_NEAR(place(Season::bud).report.leaf_area / summer.report.leaf_area, 0.0625, 0.01);
    EXPECT_NEAR(place(Season::young).report.leaf_area / summer.report.leaf_area, 0.49, 0.05);
    const Foliage autumn = place(Season::autumn);
    EXPECT_NEAR(static_cast<double>(autumn.report.leaves) / static_cast<double>(summer.report.leaves), 0.8,
                0.05);
    EXPECT_GT(autumn.instances.colors[0][0], summer.instances.colors[0][0] + 30);
    rules.evergreen = true;
    EXPECT_EQ(place(Season::winter).report.leaves, summer.report.leaves);
}

TEST(Placement, density_is_the_share_of_leaves) {
    const Skeleton skeleton = test::make_shoot_tree(100).make();
    LeafRules rules{.max_radius = 0.004f, .internode = 0.01f};
    const double all = static_cast<double>(place_leaves(skeleton, make_models(), rules).report.leaves);
    rules.density = 0.3f;
    const double some = static_cast<double>(place_leaves(skeleton, make_models(), rules).report.leaves);
    EXPECT_NEAR(some / all, 0.3, 0.03);
}

TEST(Placement, maximum_index_thins_leaves_out) {
    const Skeleton tree = test::make_shoot_tree(60).make();
    LeafRules rules{.max_radius = 0.004f, .shoot_length = 0.5f};
    const FoliageReport all = place_leaves(tree, make_models(), rules).report;
    rules.max_index = static_cast<float>(0.5 * all.leaf_area_index);
    const FoliageReport half = place_leaves(tree, make_models(), rules).report;
    EXPECT_NEAR(half.leaf_area_index, 0.5 * all.leaf_area_index, 0.02 * all.leaf_area_index);
    // The leaves of other seasons are some of the same.
    rules.season = Season::young;
    // Smaller ones do not reach wood.
    EXPECT_NEAR(static_cast<double>(place_leaves(tree, make_models(), rules).report.leaves),
                static_cast<double>(half.leaves), 5);
    rules.season = Season::summer;
    rules.max_index = static_cast<float>(2 * all.leaf_area_index);
    EXPECT_EQ(place_leaves(tree, make_models(), rules).report.leaves, all.leaves);
}

TEST(Placement, thick_tips_and_low_orders_are_bare) {
    const Skeleton skeleton = test::make_shoot_tree(10).make();
    EXPECT_EQ(place_leaves(skeleton, make_models(), {}).report.shoots, 10u);
    EXPECT_EQ(place_leaves(skeleton, make_models(), {.min_order = 2}).report.shoots, 0u);
    const FoliageReport thin =
        place_leaves(skeleton, make_models(), {.max_radius = 0.001f, .min_order = 0}).report;
    EXPECT_EQ(thin.leaves, 0u);
    EXPECT_EQ(thin.thick_tips, 11u);  // with that of the trunk
}

TEST(Placement, report_adds_up) {
    const Skeleton skeleton = test::make_shoot_tree(30).make();
    const std::vector<LeafModel> models = make_models();
    const auto [leaves, report] = place_leaves(skeleton, models, {});
    double area = 0;
    for (std::size_t i = 0; i < leaves.size(); ++i)
        area += double{leaves.scales[i]} * double{leaves.scales[i]} * models[leaves.prototypes[i]].area;
    EXPECT_EQ(report.leaves, leaves.size());
    EXPECT_NEAR(report.leaf_area, area, 1e-9);
    EXPECT_NEAR(report.leaf_area_index, report.leaf_area / report.crown_area, 1e-12);
    // The shoots reach 0.6 m, at an angle of at most 42 degrees, and the leaves 0.1 m further.
    EXPECT_GT(report.crown_area, std::numbers::pi * 0.44 * 0.44);
    EXPECT_LT(report.crown_area, std::numbers::pi * 0.72 * 0.72);
}

TEST(Placement, accepts_skeletons_without_shoots) {
    EXPECT_EQ(place_leaves(Skeleton{}, make_models(), {}).report.leaves, 0u);
    const Skeleton node({NodeId{}}, {Vec3{}}, {0.1f});
    EXPECT_EQ(place_leaves(node, make_models(), {.min_order = 0}).report.leaves, 0u);
}

TEST(Placement, refuses_bad_input_in_one_sentence) {
    const Skeleton shoot = make_level_shoot();
    EXPECT_EQ(error_of([&] { place_leaves(shoot, {}, {}); }),
              "leaves: there is no model of a leaf; add at least one");
    EXPECT_EQ(error_of([&] { place_leaves(shoot, make_models(), {.density = 2}); }),
              "leaves: density must be between 0 and 1, but is 2");
    EXPECT_EQ(error_of([&] {
                  place_leaves(shoot, make_models(), {.summer_color = Vec3d{0, 0, 9}});
              }),
              "leaves: summer_color must have three values from 0 to 1, but has 9");
    test::ShootTree tree;
    const NodeId root = tree.add({}, {}, 0.01f);
    for (int i = 0; i < 900; ++i) tree.add(root, {100, static_cast<float>(i), 0}, 0.002f);
    LeafRules rules{.shoot_length = 100, .min_order = 1, .internode = 2e-4f, .whorl = 50};
    rules.arrangement = LeafArrangement::whorled;
    EXPECT_EQ(error_of([&] { place_leaves(tree.make(), make_models(), rules); }),
              "leaves: there are more than 20 million leaves; increase internode, or reduce shoot_length or "
              "max_radius");
}

}  // namespace
}  // namespace coppice
