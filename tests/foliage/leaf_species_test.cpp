#include "coppice/foliage/leaf_species.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "coppice/base/check_fields.h"
#include "foliage/shoots.h"

namespace coppice {
namespace {

struct Range {
    double low, high;
};

/// Sizes of leaves and distances of nodes in floras [cm], and inclinations [degrees]; a high of 0: not given.
struct Measures {
    std::string name;
    Range length, width, petiole, internode, inclination;
};

const std::vector<Measures>& list_measures() {
    static const std::vector<Measures> kMeasures{
        {"beech", {5, 10}, {3, 7}, {0.8, 1.5}, {2, 4}, {15, 35}},
        {"oak", {5, 14}, {4, 8}, {0.2, 0.7}, {1, 3}, {30, 45}},
        {"birch", {3, 7}, {2.5, 5}, {1, 2}, {2, 4}, {40, 60}},
        {"pine", {2.5, 5}, {0.1, 0.2}, {0.5, 1}, {1.0 / 14, 1.0 / 8}, {}},
        {"spruce", {1.2, 2.4}, {0.05, 0.15}, {}, {1.0 / 25, 1.0 / 15}, {}},
        {"willow", {4, 16}, {0.5, 2}, {0.3, 0.5}, {2, 4}, {60, 80}},
        {"poplar", {5, 8}, {5, 7}, {2, 6}, {2, 4}, {50, 70}},
        {"horse_chestnut", {13, 30}, {}, {7, 20}, {4, 10}, {}},
        {"apple", {5, 12}, {3, 6}, {2, 5}, {2, 3}, {35, 45}},
        {"field_maple", {4, 8}, {5, 10}, {3, 9}, {3, 6}, {15, 30}},
        {"cherry", {5, 13}, {2.5, 6.5}, {1.5, 3}, {2, 3}, {40, 60}},
        {"olive", {4, 10}, {1, 3}, {0.5, 1}, {1, 3}, {40, 60}},
        {"hawthorn", {2, 4}, {2, 4}, {0.5, 3}, {1, 3}, {30, 45}},
        {"coconut", {60, 90}, {2, 5}, {100, 150}, {}, {}},
        {"fern", {}, {}, {15, 40}, {}, {}},
        {"cypress", {0.2, 0.5}, {}, {}, {}, {}},
        {"hazel", {6, 12}, {6, 12}, {0.8, 1.5}, {3, 6}, {15, 30}},
    };
    return kMeasures;
}

void expect_in(double value, Range range, const std::string& text) {
    if (range.high == 0) return;
    constexpr double kRounding = 1e-4;
    EXPECT_GE(value, range.low - kRounding) << text;
    EXPECT_LE(value, range.high + kRounding) << text;
}

/// Returns one flat blade or needle without a petiole.
LeafShape make_blade(LeafShape shape) {
    shape.fold = shape.cup = shape.curl = shape.arch = shape.wave = shape.blade_angle = 0;
    shape.petiole_length = 0;
    if (shape.parts != LeafParts::needles) shape.parts = LeafParts::simple;
    shape.leaflets = 1;
    return shape;
}

TEST(LeafSpecies, has_all_species_of_the_table) {
    EXPECT_EQ(leaf_species().size(), list_measures().size());
    for (const Measures& m : list_measures()) EXPECT_TRUE(find_leaf_species(m.name)) << m.name;
    EXPECT_FALSE(find_leaf_species("lamp"));
}

TEST(LeafSpecies, options_are_in_range) {
    for (const LeafSpecies& species : leaf_species()) {
        EXPECT_NO_THROW(check_fields(species.shape, "leaf")) << species.name;
        EXPECT_NO_THROW(check_fields(species.rules, "leaves")) << species.name;
    }
}

TEST(LeafSpecies, sizes_of_made_leaves_are_in_the_ranges_of_floras) {
    for (const Measures& m : list_measures()) {
        const LeafSpecies species = *find_leaf_species(m.name);
        float left = 0, right = 0, tip = 0;
        for (const Vec3 p : make_leaf(make_blade(species.shape)).prototype.mesh.positions) {
            left = std::min(left, p.x);
            right = std::max(right, p.x);
            tip = std::max(tip, p.y);
        }
        expect_in(100 * double{tip}, m.length, m.name + " length");
        expect_in(100 * double{right - left}, m.width, m.name + " width");
        expect_in(100 * double{species.shape.petiole_length}, m.petiole, m.name + " petiole");
        expect_in(100 * double{species.rules.internode}, m.internode, m.name + " internode");
    }
}

/// Mean inclinations on shoots in all directions, with a tolerance of 5 degrees.
TEST(LeafSpecies, inclinations_are_in_the_ranges_of_measurements) {
    const Skeleton tree = test::make_shoot_tree(60).make();
    for (const Measures& m : list_measures()) {
        const LeafSpecies species = *find_leaf_species(m.name);
        const std::vector<LeafModel> models{make_leaf_card(species.shape)};
        LeafRules rules = species.rules;
        rules.max_radius = 0.004f;
        const FoliageReport report = place_leaves(tree, models, rules).report;
        const double degrees = report.mean_inclination * 180 / std::numbers::pi;
        expect_in(degrees, {m.inclination.low - 5, m.inclination.high == 0 ? 0 : m.inclination.high + 5},
                  m.name + " inclination");
    }
}

}  // namespace
}  // namespace coppice
