#include "coppice/foliage/organ_species.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "coppice/foliage/leaf_species.h"
#include "coppice/foliage/tree_foliage.h"
#include "foliage/shoots.h"

namespace coppice {
namespace {

/// Lengths and widths of flowers (their diameter) and fruit in floras [cm].
struct Measures {
    std::string species, organ;
    double low, high;
};

const std::vector<Measures>& list_measures() {
    static const std::vector<Measures> kMeasures{
        {"apple", "apple_blossom", 3, 4},
        {"apple", "apple", 5, 9},
        {"cherry", "cherry_blossom", 3, 5},
        {"horse_chestnut", "chestnut_burr", 5, 6},
        {"hawthorn", "may_blossom", 1, 1.5},
        {"hawthorn", "haws", 0.8, 1.2},
        {"oak", "acorn", 2, 2.5},
        {"beech", "beech_husk", 1.5, 2.5},
        {"birch", "birch_catkin", 3, 6},
        {"pine", "pine_cone", 3, 7.5},
        {"spruce", "spruce_cone", 9, 17},
        {"willow", "willow_catkin", 2, 5},
        {"field_maple", "maple_samaras", 2, 3},
        {"coconut", "coconuts", 20, 30},
        {"olive", "olive", 1, 2.5},
        {"cypress", "cypress_cone", 2.5, 4},
        {"hazel", "hazel_catkin", 5, 12},
        {"hazel", "hazelnut", 1.5, 2},
    };
    return kMeasures;
}

TEST(OrganSpecies, sizes_are_in_the_ranges_of_floras) {
    for (const Measures& m : list_measures()) {
        const auto organs = find_organs(m.species);
        const auto found = std::ranges::find(organs, m.organ, &Organ::name);
        ASSERT_NE(found, organs.end()) << m.organ;
        const bool is_flower = found->shape.form == OrganForm::flower;
        const double size = 100 * double{found->shape.length} * (is_flower ? 2 : 1);
        EXPECT_GE(size, m.low - 0.001) << m.organ;
        EXPECT_LE(size, m.high + 0.001) << m.organ;
    }
}

TEST(OrganSpecies, have_unique_names_and_shares_in_range) {
    std::set<std::string_view> names;
    for (const LeafSpecies& species : leaf_species()) {
        for (const Organ& organ : find_organs(species.name)) {
            EXPECT_TRUE(names.insert(organ.name).second) << organ.name;
            for (const float share : organ.shares) {
                EXPECT_GE(share, 0);
                EXPECT_LE(share, 1);
            }
            EXPECT_GT(*std::ranges::max_element(organ.shares), 0) << organ.name;
            EXPECT_NO_THROW(make_organ(organ.shape, kFruitMaterial)) << organ.name;
        }
    }
    EXPECT_GT(names.size(), 30u);
    EXPECT_TRUE(find_organs("fern").empty());
}

/// Every organ hangs on branchlets without floating or entering the trunk.
TEST(OrganSpecies, clusters_begin_on_bark_outside_of_wood) {
    const Skeleton tree = test::make_shoot_tree(30).make();
    const BranchletOptions branchlets{.length = 0.3f, .laterals = 4, .spacing = 0.1f};
    for (const LeafSpecies& species : leaf_species()) {
        for (const Season season : {Season::young, Season::autumn}) {
            LeafRules rules = species.rules;
            rules.season = season;
            rules.max_radius = 0.004f;
            const TreeFoliage made =
                make_foliage(tree, {.rows = 2}, rules, branchlets, 2, {find_organs(species.name), {}});
            validate(made.prototypes, made.foliage.instances);
            EXPECT_EQ(made.foliage.report.floating, 0u);
            for (std::size_t i = 0; i < made.foliage.instances.size(); ++i) {
                if (made.prototypes[made.foliage.instances.prototypes[i]].material < kFlowerMaterial)
                    continue;
                // The trunk has a radius of 5 cm around the z axis.
                const Vec3 p = made.foliage.instances.positions[i];
                EXPECT_GT(std::hypot(p.x, p.y), 0.0485f) << species.name;
            }
        }
    }
}

TEST(OrganSpecies, factors_change_numbers_of_flowers_and_fruit) {
    const Skeleton tree = test::make_shoot_tree(20).make();
    LeafRules rules = find_leaf_species("apple")->rules;
    rules.max_radius = 0.004f;
    rules.season = Season::young;
    const auto count = [&](OrganOptions options) {
        return make_foliage(tree, {.rows = 2}, rules, {}, 2, {find_organs("apple"), options}).foliage.report;
    };
    const FoliageReport usual = count({});
    EXPECT_GT(usual.flowers, 100u);
    EXPECT_EQ(usual.fruit, 0u);
    EXPECT_EQ(count({.flower_density = 0}).flowers, 0u);
    EXPECT_LT(count({.flower_density = 0.5f}).flowers, usual.flowers);
    rules.season = Season::autumn;
    EXPECT_GT(count({}).fruit, 5u);
    EXPECT_EQ(count({}).flowers, 0u);
    EXPECT_EQ(count({.fruit_density = 0}).fruit, 0u);
}

TEST(OrganSpecies, threads_give_the_same_bits) {
    const Skeleton tree = test::make_shoot_tree(40).make();
    LeafRules rules = find_leaf_species("cherry")->rules;
    rules.max_radius = 0.004f;
    rules.season = Season::bud;
    const BranchletOptions branchlets{.length = 0.2f, .laterals = 3, .spacing = 0.1f};
    const FoliageOrgans organs{find_organs("cherry"), {}};
    const TreeFoliage one = make_foliage(tree, {}, rules, branchlets, 3, organs, {.threads = 1});
    const TreeFoliage four = make_foliage(tree, {}, rules, branchlets, 3, organs, {.threads = 4});
    EXPECT_EQ(one.foliage.instances.positions, four.foliage.instances.positions);
    EXPECT_EQ(one.foliage.instances.colors, four.foliage.instances.colors);
    EXPECT_EQ(one.foliage.report.flowers, four.foliage.report.flowers);
}

}  // namespace
}  // namespace coppice
