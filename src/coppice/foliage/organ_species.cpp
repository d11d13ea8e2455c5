#include "coppice/foliage/organ_species.h"

#include <map>
#include <string>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/base/srgb.h"

namespace coppice {
namespace {

constexpr Vec3d kStalk = srgb(120, 140, 62), kWoody = srgb(104, 84, 58), kAnther = srgb(226, 196, 92);

/// Returns the shape of a hanging catkin.
OrganShape make_catkin(int count, float length, float width, Vec3d color, Vec3d other) {
    return {.form = OrganForm::cone,
            .cluster = count > 1 ? OrganCluster::umbel : OrganCluster::single,
            .count = count,
            .length = length,
            .width = width,
            .stalk_length = 0.004f,
            .stalk_width = 0.0015f,
            .spread = 0.16f,
            .opening = 0.3f,
            .scales = 90,
            .color = color,
            .other_color = other,
            .stalk_color = kWoody};
}

/// Returns the shape of a woody cone.
OrganShape make_cone(float length, float width, int scales, float opening, Vec3d color, Vec3d other) {
    return {.form = OrganForm::cone,
            .length = length,
            .width = width,
            .stalk_length = 0.006f,
            .stalk_width = 0.005f,
            .opening = opening,
            .scales = scales,
            .color = color,
            .other_color = other,
            .stalk_color = kWoody};
}

std::vector<Organ> make_apple() {
    const OrganShape blossom{.form = OrganForm::flower,
                             .cluster = OrganCluster::umbel,
                             .count = 5,
                             .length = 0.018f,
                             .width = 0.0135f,
                             .axis_length = 0.008f,
                             .stalk_length = 0.024f,
                             .stalk_width = 0.0014f,
                             .spread = 1.0f,
                             .opening = 1.2f,
                             .stamens = 14,
                             .color = srgb(252, 240, 240),
                             .other_color = srgb(246, 206, 216),
                             .detail_color = kAnther,
                             .stalk_color = kStalk};
    OrganShape fruit{.length = 0.063f,
                     .width = 0.067f,
                     .stalk_length = 0.022f,
                     .stalk_width = 0.002f,
                     .dimple = 0.14f,
                     .color = srgb(176, 34, 30),
                     .other_color = srgb(208, 122, 62),
                     .detail_color = srgb(74, 60, 40),
                     .stalk_color = kWoody};
    OrganShape green = fruit;
    green.length = 0.042f;
    green.width = 0.046f;
    green.color = srgb(126, 152, 62);
    green.other_color = srgb(156, 164, 78);
    const Organ ripe{.name = "apple",
                     .is_fruit = true,
                     .shape = fruit,
                     .internode = 0.24f,
                     .angle = 1.0f,
                     .hang = 0.9f,
                     .shares = {0, 0, 0, 0.22f, 0}};
    Organ unripe = ripe;
    unripe.name = "green_apple";
    unripe.shape = green;
    unripe.shares = {0, 0, 0.25f, 0, 0};
    return {{.name = "apple_blossom",
             .shape = blossom,
             .internode = 0.055f,
             .angle = 0.7f,
             .hang = -0.35f,
             .shares = {0, 0.75f, 0, 0, 0}},
            unripe,
            ripe};
}

std::vector<Organ> make_cherry() {
    return {{.name = "cherry_blossom",
             .shape = {.form = OrganForm::flower,
                       .cluster = OrganCluster::umbel,
                       .count = 4,
                       .length = 0.02f,
                       .width = 0.017f,
                       .axis_length = 0.012f,
                       .stalk_length = 0.028f,
                       .stalk_width = 0.0013f,
                       .spread = 0.8f,
                       .whorls = 4,
                       .opening = 1.15f,
                       .stamens = 6,
                       .color = srgb(247, 196, 214),
                       .other_color = srgb(252, 224, 232),
                       .detail_color = kAnther,
                       .stalk_color = srgb(134, 120, 62)},
             .internode = 0.045f,
             .angle = 0.9f,
             .hang = 0.45f,
             .shares = {0.9f, 0.7f, 0, 0, 0}},
            {.name = "cherry",
             .is_fruit = true,
             .shape = {.cluster = OrganCluster::umbel,
                       .count = 2,
                       .length = 0.0095f,
                       .width = 0.0095f,
                       .stalk_length = 0.028f,
                       .spread = 0.4f,
                       .color = srgb(96, 18, 30),
                       .other_color = srgb(46, 14, 24),
                       .stalk_color = kStalk},
             .internode = 0.12f,
             .hang = 0.85f,
             .shares = {0, 0, 0.12f, 0, 0}}};
}

std::vector<Organ> make_horse_chestnut() {
    const OrganShape fruit{.form = OrganForm::burr,
                           .cluster = OrganCluster::umbel,
                           .count = 2,
                           .length = 0.054f,
                           .width = 0.052f,
                           .axis_length = 0.06f,
                           .stalk_length = 0.018f,
                           .stalk_width = 0.004f,
                           .spread = 0.7f,
                           .scales = 60,
                           .color = srgb(126, 142, 62),
                           .other_color = srgb(154, 136, 66),
                           .stalk_color = kStalk};
    return {{.name = "chestnut_panicle",
             .shape = {.form = OrganForm::flower,
                       .cluster = OrganCluster::raceme,
                       .count = 48,
                       .length = 0.014f,
                       .width = 0.0095f,
                       .axis_length = 0.2f,
                       .stalk_length = 0.045f,
                       .stalk_width = 0.0016f,
                       .spread = 1.25f,
                       .petals = 4,
                       .opening = 0.95f,
                       .stamens = 6,
                       .color = srgb(252, 248, 238),
                       .other_color = srgb(250, 236, 222),
                       .detail_color = srgb(220, 120, 100),
                       .stalk_color = srgb(150, 164, 84)},
             .shoot_length = 0.001f,
             .angle = 0,
             .spread = 0.12f,
             .hang = -0.8f,
             .shares = {0, 0.6f, 0, 0, 0}},
            {.name = "chestnut_burr",
             .is_fruit = true,
             .shape = fruit,
             .shoot_length = 0.001f,
             .angle = 0.4f,
             .hang = 0.8f,
             .shares = {0, 0, 0.25f, 0.22f, 0}}};
}

std::vector<Organ> make_hawthorn() {
    return {{.name = "may_blossom",
             .shape = {.form = OrganForm::flower,
                       .cluster = OrganCluster::corymb,
                       .count = 12,
                       .length = 0.0062f,
                       .width = 0.0062f,
                       .axis_length = 0.02f,
                       .stalk_length = 0.012f,
                       .stalk_width = 0.0009f,
                       .spread = 0.85f,
                       .opening = 1.15f,
                       .stamens = 8,
                       .color = srgb(253, 250, 244),
                       .other_color = srgb(250, 234, 232),
                       .detail_color = srgb(222, 128, 128),
                       .stalk_color = kStalk},
             .internode = 0.07f,
             .angle = 0.7f,
             .hang = -0.5f,
             .shares = {0, 0.75f, 0, 0, 0}},
            {.name = "haws",
             .is_fruit = true,
             .shape = {.cluster = OrganCluster::corymb,
                       .count = 5,
                       .length = 0.0105f,
                       .width = 0.0095f,
                       .axis_length = 0.014f,
                       .stalk_length = 0.014f,
                       .spread = 0.8f,
                       .dimple = 0.05f,
                       .color = srgb(132, 18, 24),
                       .other_color = srgb(160, 40, 28),
                       .detail_color = srgb(70, 40, 30),
                       .stalk_color = kStalk},
             .internode = 0.09f,
             .hang = 0.3f,
             .shares = {0, 0, 0, 0.5f, 0.12f}}};
}

std::vector<Organ> make_oak() {
    OrganShape acorn{.form = OrganForm::nut,
                     .cluster = OrganCluster::raceme,
                     .count = 2,
                     .length = 0.025f,
                     .width = 0.0145f,
                     .axis_length = 0.045f,
                     .stalk_length = 0.004f,
                     .stalk_width = 0.0017f,
                     .spread = 0.7f,
                     .color = srgb(142, 98, 50),
                     .other_color = srgb(160, 130, 66),
                     .detail_color = srgb(128, 118, 84),
                     .stalk_color = kStalk};
    const Organ ripe{.name = "acorn",
                     .is_fruit = true,
                     .shape = acorn,
                     .shoot_length = 0.12f,
                     .internode = 0.06f,
                     .hang = 0.5f,
                     .shares = {0, 0, 0, 0.08f, 0}};
    Organ unripe = ripe;
    unripe.name = "green_acorn";
    unripe.shape.length = 0.019f;
    unripe.shape.width = 0.0125f;
    unripe.shape.color = srgb(134, 158, 72);
    unripe.shape.other_color = srgb(150, 164, 84);
    unripe.shares = {0, 0, 0.09f, 0, 0};
    return {{.name = "oak_catkin",
             .shape = make_catkin(4, 0.035f, 0.004f, srgb(178, 180, 84), srgb(196, 186, 96)),
             .shoot_length = 0.12f,
             .internode = 0.05f,
             .hang = 0.9f,
             .shares = {0.5f, 0.3f, 0, 0, 0}},
            unripe,
            ripe};
}

std::vector<Organ> make_beech() {
    return {{.name = "beech_husk",
             .is_fruit = true,
             .shape = {.form = OrganForm::burr,
                       .length = 0.021f,
                       .width = 0.019f,
                       .stalk_length = 0.016f,
                       .stalk_width = 0.002f,
                       .scales = 44,
                       .color = srgb(140, 118, 66),
                       .other_color = srgb(124, 96, 56),
                       .stalk_color = kStalk},
             .shoot_length = 0.1f,
             .internode = 0.06f,
             .hang = -0.3f,
             .shares = {0, 0, 0.06f, 0.1f, 0}}};
}

std::vector<Organ> make_birch() {
    OrganShape seeds = make_catkin(1, 0.028f, 0.0085f, srgb(124, 146, 66), srgb(146, 150, 76));
    seeds.stalk_length = 0.012f;
    const Organ ripening{.name = "birch_seed_catkin",
                         .is_fruit = true,
                         .shape = seeds,
                         .shoot_length = 0.4f,
                         .internode = 0.09f,
                         .hang = 0.75f,
                         .shares = {0, 0, 0.3f, 0, 0}};
    Organ ripe = ripening;
    ripe.name = "ripe_birch_catkin";
    ripe.shape.color = srgb(140, 110, 66);
    ripe.shape.other_color = srgb(120, 92, 56);
    ripe.shares = {0, 0, 0, 0.3f, 0.1f};
    return {{.name = "birch_catkin",
             .shape = make_catkin(3, 0.048f, 0.0065f, srgb(196, 172, 78), srgb(170, 138, 66)),
             .shoot_length = 0.05f,
             .internode = 0.1f,
             .angle = 0.4f,
             .hang = 0.9f,
             .shares = {0.8f, 0.4f, 0, 0, 0}},
            ripening,
            ripe};
}

std::vector<Organ> make_pine() {
    OrganShape pollen = make_catkin(14, 0.008f, 0.0045f, srgb(224, 196, 92), srgb(206, 170, 74));
    pollen.cluster = OrganCluster::raceme;
    pollen.axis_length = 0.035f;
    pollen.stalk_length = 0.002f;
    pollen.spread = 1.1f;
    pollen.scales = 24;
    Organ green{.name = "green_pine_cone",
                .is_fruit = true,
                .shape = make_cone(0.044f, 0.024f, 64, 0.15f, srgb(108, 122, 64), srgb(124, 124, 74)),
                .shoot_length = 0.15f,
                .internode = 0.1f,
                .angle = 1.5f,
                .hang = 0.6f,
                .min_height = 0.45f,
                .shares = {0, 0, 0.12f, 0.12f, 0.12f}};
    Organ open = green;
    open.name = "pine_cone";
    open.shape = make_cone(0.05f, 0.034f, 64, 1.0f, srgb(146, 118, 88), srgb(120, 96, 72));
    open.shoot_length = 0.4f;
    open.internode = 0.16f;
    open.shares = {0.14f, 0.14f, 0.14f, 0.14f, 0.14f};
    return {{.name = "pine_pollen_cones",
             .shape = pollen,
             .shoot_length = 0.001f,
             .angle = 0,
             .min_height = 0.3f,
             .shares = {0, 0.5f, 0, 0, 0}},
            green,
            open};
}

std::vector<Organ> make_spruce() {
    Organ ripe{.name = "spruce_cone",
               .is_fruit = true,
               .shape = make_cone(0.13f, 0.036f, 150, 0.25f, srgb(126, 90, 60), srgb(108, 80, 58)),
               .shoot_length = 0.1f,
               .internode = 0.2f,
               .angle = 0.5f,
               .spread = 0.15f,
               .hang = 0.95f,
               .min_height = 0.66f,
               .shares = {0.03f, 0.03f, 0, 0.05f, 0.04f}};
    Organ green = ripe;
    green.name = "green_spruce_cone";
    green.shape.color = srgb(118, 128, 70);
    green.shape.other_color = srgb(126, 96, 72);
    green.shape.opening = 0.1f;
    green.shares = {0, 0, 0.05f, 0, 0};
    return {green, ripe};
}

std::vector<Organ> make_willow() {
    return {{.name = "willow_catkin",
             .shape = make_catkin(1, 0.035f, 0.0065f, srgb(206, 196, 96), srgb(184, 184, 90)),
             .internode = 0.06f,
             .angle = 0.6f,
             .shares = {0.5f, 0.35f, 0, 0, 0}}};
}

std::vector<Organ> make_poplar() {
    return {{.name = "poplar_catkin",
             .shape = make_catkin(1, 0.06f, 0.008f, srgb(150, 44, 48), srgb(122, 40, 44)),
             .internode = 0.08f,
             .angle = 0.7f,
             .hang = 0.85f,
             .shares = {0.7f, 0, 0, 0, 0}}};
}

std::vector<Organ> make_field_maple() {
    OrganShape wings{.form = OrganForm::samara,
                     .cluster = OrganCluster::corymb,
                     .count = 4,
                     .length = 0.028f,
                     .width = 0.0095f,
                     .axis_length = 0.025f,
                     .stalk_length = 0.02f,
                     .spread = 0.7f,
                     .opening = 1.55f,
                     .color = srgb(142, 160, 76),
                     .other_color = srgb(186, 128, 96),
                     .stalk_color = kStalk};
    const Organ green{.name = "maple_samaras",
                      .is_fruit = true,
                      .shape = wings,
                      .shoot_length = 0.06f,
                      .internode = 0.1f,
                      .angle = 0.4f,
                      .hang = 0.75f,
                      .shares = {0, 0, 0.5f, 0, 0}};
    Organ ripe = green;
    ripe.name = "ripe_maple_samaras";
    ripe.shape.color = srgb(168, 130, 80);
    ripe.shape.other_color = srgb(146, 106, 66);
    ripe.shares = {0, 0, 0, 0.5f, 0.08f};
    return {{.name = "maple_flowers",
             .shape = {.form = OrganForm::flower,
                       .cluster = OrganCluster::corymb,
                       .count = 12,
                       .length = 0.0038f,
                       .width = 0.0016f,
                       .axis_length = 0.022f,
                       .stalk_length = 0.012f,
                       .stalk_width = 0.0008f,
                       .spread = 0.8f,
                       .opening = 0.9f,
                       .stamens = 8,
                       .color = srgb(186, 196, 92),
                       .other_color = srgb(170, 186, 84),
                       .detail_color = kAnther,
                       .stalk_color = kStalk},
             .shoot_length = 0.06f,
             .internode = 0.1f,
             .angle = 0.2f,
             .shares = {0, 0.5f, 0, 0, 0}},
            green,
            ripe};
}

std::vector<Organ> make_coconut() {
    return {{.name = "coconuts",
             .is_fruit = true,
             .shape = {.cluster = OrganCluster::raceme,
                       .count = 7,
                       .length = 0.25f,
                       .width = 0.2f,
                       .axis_length = 0.5f,
                       .stalk_length = 0.14f,
                       .stalk_width = 0.025f,
                       .spread = 1.3f,
                       .color = srgb(122, 140, 58),
                       .other_color = srgb(178, 140, 66),
                       .stalk_color = srgb(170, 150, 76)},
             .shoot_length = 0.35f,
             .internode = 0.04f,
             .angle = 1.3f,
             .hang = 0.55f,
             .shares = {0.8f, 0.8f, 0.8f, 0.8f, 0.8f}}};
}

std::vector<Organ> make_olive() {
    OrganShape drupe{.cluster = OrganCluster::raceme,
                     .count = 2,
                     .length = 0.02f,
                     .width = 0.0135f,
                     .axis_length = 0.015f,
                     .stalk_length = 0.007f,
                     .spread = 0.8f,
                     .color = srgb(132, 142, 70),
                     .other_color = srgb(150, 150, 84),
                     .stalk_color = kStalk};
    const Organ green{.name = "green_olive",
                      .is_fruit = true,
                      .shape = drupe,
                      .internode = 0.11f,
                      .hang = 0.75f,
                      .shares = {0, 0, 0.35f, 0, 0}};
    Organ ripe = green;
    ripe.name = "olive";
    ripe.shape.color = srgb(58, 38, 54);
    ripe.shape.other_color = srgb(96, 74, 72);
    ripe.shares = {0, 0, 0, 0.35f, 0.1f};
    return {{.name = "olive_panicle",
             .shape = {.form = OrganForm::flower,
                       .cluster = OrganCluster::raceme,
                       .count = 16,
                       .length = 0.003f,
                       .width = 0.0025f,
                       .axis_length = 0.045f,
                       .stalk_length = 0.012f,
                       .stalk_width = 0.0009f,
                       .spread = 1.1f,
                       .petals = 4,
                       .stamens = 2,
                       .color = srgb(248, 246, 226),
                       .other_color = srgb(242, 238, 206),
                       .detail_color = kAnther,
                       .stalk_color = kStalk},
             .internode = 0.06f,
             .shares = {0, 0.6f, 0, 0, 0}},
            green,
            ripe};
}

std::vector<Organ> make_cypress() {
    return {{.name = "cypress_cone",
             .is_fruit = true,
             .shape = make_cone(0.031f, 0.027f, 13, 0.1f, srgb(126, 118, 92), srgb(104, 112, 78)),
             .internode = 0.3f,
             .min_height = 0.15f,
             .shares = {0.15f, 0.15f, 0.15f, 0.15f, 0.15f}}};
}

std::vector<Organ> make_hazel() {
    OrganShape nuts{.form = OrganForm::nut,
                    .cluster = OrganCluster::umbel,
                    .count = 3,
                    .length = 0.019f,
                    .width = 0.0165f,
                    .axis_length = 0.012f,
                    .stalk_length = 0.004f,
                    .stalk_width = 0.0015f,
                    .spread = 1.0f,
                    .color = srgb(150, 106, 60),
                    .other_color = srgb(168, 138, 84),
                    .detail_color = srgb(134, 150, 76),
                    .stalk_color = kStalk};
    return {{.name = "hazel_catkin",
             .shape = make_catkin(3, 0.075f, 0.0065f, srgb(206, 182, 84), srgb(190, 164, 80)),
             .internode = 0.09f,
             .hang = 0.95f,
             .shares = {0.5f, 0, 0, 0, 0.7f}},
            {.name = "hazelnut",
             .is_fruit = true,
             .shape = nuts,
             .shoot_length = 0.2f,
             .internode = 0.08f,
             .hang = 0.3f,
             .shares = {0, 0, 0.12f, 0.12f, 0}}};
}

}  // namespace

void list_fields(OrganOptions& o, FieldList& list) {
    list.add(common_field("flower_density", "Factor of the number of flowers; 0 leaves them out.", Unit::none,
                          0, 100),
             o.flower_density);
    list.add(common_field("fruit_density", "Factor of the number of fruit and cones; 0 leaves them out.",
                          Unit::none, 0, 100),
             o.fruit_density);
}

std::span<const Organ> find_organs(std::string_view species) {
    static const std::map<std::string, std::vector<Organ>, std::less<>> kOrgans{
        {"apple", make_apple()},
        {"beech", make_beech()},
        {"birch", make_birch()},
        {"cherry", make_cherry()},
        {"coconut", make_coconut()},
        {"cypress", make_cypress()},
        {"field_maple", make_field_maple()},
        {"hawthorn", make_hawthorn()},
        {"hazel", make_hazel()},
        {"horse_chestnut", make_horse_chestnut()},
        {"oak", make_oak()},
        {"olive", make_olive()},
        {"pine", make_pine()},
        {"poplar", make_poplar()},
        {"spruce", make_spruce()},
        {"willow", make_willow()}};
    const auto found = kOrgans.find(species);
    if (found == kOrgans.end()) return {};
    return found->second;
}

}  // namespace coppice
