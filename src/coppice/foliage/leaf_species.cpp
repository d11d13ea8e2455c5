#include "coppice/foliage/leaf_species.h"

#include <algorithm>
#include <vector>

#include "coppice/base/srgb.h"

namespace coppice {
namespace {

constexpr float kTwoFifths = 2.5133f;  // [rad] 144 degrees
constexpr float kGolden = 2.3998f;     // [rad] 137.5 degrees

constexpr Vec3d kYellow = srgb(224, 184, 56), kOchre = srgb(176, 120, 56), kCopper = srgb(160, 88, 44),
                kRed = srgb(170, 52, 40), kBronze = srgb(150, 110, 60);

LeafSpecies make_beech() {
    return {"beech",
            "common beech, Fagus sylvatica",
            {.outline = LeafOutline::ovate,
             .length = 0.075f,
             .width = 0.048f,
             .base_exponent = 0.7f,
             .tip_exponent = 0.9f,
             .veins = 7,
             .fold = 0.12f,
             .curl = 0.3f,
             .wave = 0.01f,
             .petiole_length = 0.01f,
             .rows = 14},
            {.arrangement = LeafArrangement::two_ranked,
             .internode = 0.028f,
             .angle = 0.95f,
             .light = 0.95f,
             .droop = 0.1f,
             .spread = 0.28f,
             .young_color = srgb(135, 170, 70),
             .summer_color = srgb(70, 100, 42),
             .autumn_color = kCopper}};
}

LeafSpecies make_oak() {
    return {"oak",
            "pedunculate oak, Quercus robur",
            {.outline = LeafOutline::obovate,
             .lobes = LeafLobes::pinnate,
             .length = 0.095f,
             .width = 0.06f,
             .base_exponent = 0.95f,
             .tip_exponent = 0.62f,
             .lobe_count = 4,
             .lobe_depth = 0.48f,
             .vein_angle = 1.05f,
             .cup = 0.1f,
             .petiole_length = 0.004f,
             .petiole_width = 0.0018f,
             .rows = 27},
            {.internode = 0.018f,
             .clustering = 0.5f,
             .divergence = kTwoFifths,
             .angle = 0.9f,
             .light = 0.75f,
             .droop = 0.25f,
             .spread = 0.4f,
             .young_color = kBronze,
             .autumn_color = kOchre}};
}

LeafSpecies make_birch() {
    return {"birch",
            "silver birch, Betula pendula",
            {.outline = LeafOutline::triangular,
             .margin = LeafMargin::double_serrate,
             .length = 0.05f,
             .width = 0.037f,
             .teeth = 12,
             .tooth_depth = 0.025f,
             .veins = 6,
             .fold = 0.15f,
             .petiole_length = 0.015f,
             .petiole_width = 0.001f,
             .rows = 24},
            {.internode = 0.03f,
             .divergence = 2.27f,
             .angle = 1.0f,
             .light = 0.6f,
             .droop = 0.75f,
             .spread = 0.35f,
             .summer_color = srgb(88, 116, 48),
             .autumn_color = kYellow}};
}

LeafSpecies make_willow() {
    return {"willow",
            "weeping willow, Salix",
            {.outline = LeafOutline::lanceolate,
             .margin = LeafMargin::serrate,
             .length = 0.1f,
             .width = 0.014f,
             .teeth = 40,
             .tooth_depth = 0.006f,
             .veins = 14,
             .fold = 0.25f,
             .curl = 0.5f,
             .petiole_length = 0.004f,
             .petiole_width = 0.001f,
             .rows = 12},
            {.shoot_length = 1.2f,
             .internode = 0.03f,
             .divergence = kGolden,
             .angle = 0.6f,
             .light = 0.25f,
             .droop = 1.2f,
             .spread = 0.25f,
             .summer_color = srgb(112, 138, 62),
             .autumn_color = kYellow}};
}

LeafSpecies make_poplar() {
    return {"poplar",
            "Lombardy poplar, Populus nigra",
            {.outline = LeafOutline::rhombic,
             .margin = LeafMargin::crenate,
             .length = 0.065f,
             .width = 0.058f,
             .base_exponent = 0.6f,
             .tip_exponent = 1.35f,
             .teeth = 12,
             .tooth_depth = 0.02f,
             .veins = 6,
             .fold = 0.1f,
             .petiole_length = 0.035f,
             .rows = 24},
            {.internode = 0.03f,
             .divergence = kGolden,
             .angle = 1.0f,
             .light = 0.5f,
             .droop = 0.95f,
             .spread = 0.3f,
             .autumn_color = kYellow}};
}

LeafSpecies make_horse_chestnut() {
    return {"horse_chestnut",
            "horse chestnut, Aesculus hippocastanum",
            {.parts = LeafParts::palmate,
             .outline = LeafOutline::obovate,
             .margin = LeafMargin::double_serrate,
             .length = 0.19f,
             .width = 0.07f,
             .base_exponent = 1.7f,
             .tip_exponent = 0.9f,
             .leaflets = 7,
             .leaflet_angle = 0.7f,
             .teeth = 20,
             .tooth_depth = 0.01f,
             .veins = 16,
             .vein_angle = 0.9f,
             .fold = 0.3f,
             .curl = 0.6f,
             .petiole_length = 0.13f,
             .petiole_width = 0.003f,
             .blade_angle = 0.35f,
             .rows = 14},
            {.arrangement = LeafArrangement::opposite,
             .internode = 0.07f,
             .clustering = 0.3f,
             .angle = 1.0f,
             .light = 0.85f,
             .droop = 0.35f,
             .spread = 0.25f,
             .autumn_color = kYellow}};
}

LeafSpecies make_apple() {
    return {"apple",
            "apple, Malus domestica",
            {.outline = LeafOutline::elliptic,
             .margin = LeafMargin::crenate,
             .length = 0.08f,
             .width = 0.045f,
             .tip_exponent = 0.95f,
             .teeth = 26,
             .tooth_depth = 0.01f,
             .fold = 0.3f,
             .petiole_length = 0.028f,
             .rows = 12},
            {.internode = 0.025f,
             .divergence = kTwoFifths,
             .angle = 0.85f,
             .light = 0.7f,
             .droop = 0.35f,
             .spread = 0.4f,
             .autumn_color = srgb(190, 150, 60)}};
}

LeafSpecies make_field_maple() {
    return {"field_maple",
            "field maple, Acer campestre",
            {.lobes = LeafLobes::palmate,
             .length = 0.058f,
             .width = 0.075f,
             .lobe_count = 5,
             .lobe_depth = 0.55f,
             .fold = 0.1f,
             .cup = 0.2f,
             .petiole_length = 0.05f,
             .petiole_width = 0.0012f,
             .rows = 40,
             .columns = 2},
            {.arrangement = LeafArrangement::opposite,
             .internode = 0.04f,
             .angle = 1.05f,
             .light = 0.9f,
             .droop = 0.15f,
             .spread = 0.25f,
             .autumn_color = srgb(230, 190, 70)}};
}

LeafSpecies make_cherry() {
    return {"cherry",
            "Japanese cherry, Prunus serrulata",
            {.outline = LeafOutline::ovate,
             .margin = LeafMargin::serrate,
             .length = 0.09f,
             .width = 0.045f,
             .tip_exponent = 1.25f,
             .teeth = 30,
             .tooth_depth = 0.012f,
             .veins = 9,
             .fold = 0.3f,
             .petiole_length = 0.022f,
             .rows = 12},
            {.internode = 0.025f,
             .divergence = kTwoFifths,
             .angle = 0.95f,
             .light = 0.6f,
             .droop = 0.65f,
             .spread = 0.35f,
             .young_color = kBronze,
             .autumn_color = kRed}};
}

LeafSpecies make_olive() {
    return {"olive",
            "olive, Olea europaea",
            {.outline = LeafOutline::lanceolate,
             .length = 0.06f,
             .width = 0.014f,
             .base_exponent = 0.9f,
             .tip_exponent = 0.95f,
             .veins = 6,
             .fold = 0.15f,
             .curl = 0.15f,
             .petiole_length = 0.006f,
             .petiole_width = 0.001f,
             .rows = 8},
            {.arrangement = LeafArrangement::opposite,
             .evergreen = true,
             .internode = 0.022f,
             .angle = 0.8f,
             .light = 0.5f,
             .droop = 0.3f,
             .spread = 0.25f,
             .young_color = srgb(140, 152, 104),
             .summer_color = srgb(104, 116, 84)}};
}

LeafSpecies make_hawthorn() {
    return {"hawthorn",
            "hawthorn, Crataegus monogyna",
            {.outline = LeafOutline::rhombic,
             .lobes = LeafLobes::pinnate,
             .length = 0.032f,
             .width = 0.03f,
             .base_exponent = 0.7f,
             .tip_exponent = 0.8f,
             .lobe_count = 2,
             .lobe_depth = 0.55f,
             .vein_angle = 0.95f,
             .petiole_length = 0.012f,
             .petiole_width = 0.001f,
             .rows = 20},
            {.internode = 0.018f,
             .divergence = kTwoFifths,
             .angle = 0.9f,
             .light = 0.75f,
             .droop = 0.25f,
             .spread = 0.4f,
             .autumn_color = srgb(168, 90, 48)}};
}

LeafSpecies make_hazel() {
    return {"hazel",
            "hazel, Corylus avellana",
            {.outline = LeafOutline::cordate,
             .margin = LeafMargin::double_serrate,
             .length = 0.09f,
             .width = 0.078f,
             .base_exponent = 0.5f,
             .tip_exponent = 0.7f,
             .teeth = 14,
             .tooth_depth = 0.02f,
             .fold = 0.15f,
             .petiole_length = 0.012f,
             .petiole_width = 0.002f,
             .rows = 28},
            {.arrangement = LeafArrangement::two_ranked,
             .internode = 0.042f,
             .angle = 1.0f,
             .light = 0.92f,
             .droop = 0.15f,
             .spread = 0.25f,
             .autumn_color = srgb(214, 180, 70)}};
}

LeafSpecies make_coconut() {
    return {"coconut",
            "coconut palm, Cocos nucifera",
            {.parts = LeafParts::pinnate,
             .outline = LeafOutline::linear,
             .length = 0.75f,
             .width = 0.045f,
             .leaflets = 121,
             .leaflet_angle = 1.0f,
             .leaflet_spacing = 1.45f,
             .leaflet_taper = 0.65f,
             .veins = 0,
             .fold = 0.35f,
             .curl = 0.9f,
             .arch = 1.1f,
             .petiole_length = 1.2f,
             .petiole_width = 0.06f,
             .blade_angle = 0.35f,
             .rows = 5},
            {.evergreen = true,
             .max_radius = 1,
             .shoot_length = 0.6f,
             .min_order = 0,
             .internode = 0.018f,
             .divergence = 2.4435f,
             .angle = 1.45f,
             .light = 0.1f,
             .droop = 0.1f,
             .spread = 0.2f,
             .base_size = 1,
             .young_color = srgb(120, 150, 60),
             .summer_color = srgb(92, 118, 50)}};
}

LeafSpecies make_fern() {
    return {"fern",
            "male fern, Dryopteris filix-mas",
            {.parts = LeafParts::pinnate,
             .outline = LeafOutline::lanceolate,
             .margin = LeafMargin::crenate,
             .length = 0.13f,
             .width = 0.03f,
             .leaflets = 53,
             .leaflet_angle = 1.35f,
             .leaflet_spacing = 0.95f,
             .leaflet_taper = 0.92f,
             .teeth = 14,
             .tooth_depth = 0.02f,
             .fold = 0.1f,
             .curl = 0.4f,
             .arch = 0.9f,
             .petiole_length = 0.3f,
             .petiole_width = 0.007f,
             .blade_angle = 0.1f,
             .rows = 30},
            {.max_radius = 1,
             .shoot_length = 0.08f,
             .min_order = 0,
             .internode = 0.007f,
             .divergence = kGolden,
             .angle = 0.5f,
             .light = 0,
             .droop = 0,
             .spread = 0.12f,
             .base_size = 0.9f,
             .young_color = srgb(128, 160, 64),
             .summer_color = srgb(78, 112, 44),
             .autumn_color = srgb(150, 104, 56)}};
}

LeafSpecies make_cypress() {
    return {"cypress",
            "Mediterranean cypress, Cupressus sempervirens",
            {.parts = LeafParts::needles,
             .length = 0.005f,
             .width = 0.0018f,
             .leaflets = 1,
             .curl = -0.1f,
             .petiole_length = 0,
             .rows = 2},
            {.arrangement = LeafArrangement::opposite,
             .evergreen = true,
             .shoot_length = 0.2f,
             .internode = 0.003f,
             .angle = 0.3f,
             .light = 0,
             .droop = 0,
             .spread = 0.08f,
             .base_size = 1,
             .young_color = srgb(100, 128, 72),
             .summer_color = srgb(58, 84, 56)}};
}

LeafSpecies make_pine() {
    return {"pine",
            "Scots pine, Pinus sylvestris",
            {.parts = LeafParts::needles,
             .length = 0.045f,
             .width = 0.0016f,
             .leaflets = 2,
             .leaflet_angle = 0.1f,
             .curl = -0.25f,
             .petiole_length = 0.007f,
             .petiole_width = 0.002f,
             .rows = 3},
            {.evergreen = true,
             .shoot_length = 0.2f,
             .internode = 0.001f,
             .divergence = kGolden,
             .angle = 0.8f,
             .light = 0,
             .droop = 0,
             .spread = 0.15f,
             .base_size = 1,
             .young_color = srgb(112, 148, 90),
             .summer_color = srgb(72, 104, 80)}};
}

LeafSpecies make_spruce() {
    return {"spruce",
            "Norway spruce, Picea abies",
            {.parts = LeafParts::needles,
             .length = 0.018f,
             .width = 0.001f,
             .leaflets = 1,
             .curl = -0.2f,
             .petiole_length = 0.001f,
             .petiole_width = 0.0008f,
             .rows = 2},
            {.evergreen = true,
             .shoot_length = 0.25f,
             .internode = 0.0005f,
             .divergence = kGolden,
             .angle = 1.0f,
             .light = 0.15f,
             .droop = -0.15f,
             .spread = 0.12f,
             .base_size = 1,
             .young_color = srgb(130, 176, 70),
             .summer_color = srgb(46, 74, 42)}};
}

}  // namespace

std::span<const LeafSpecies> leaf_species() {
    static const std::vector<LeafSpecies> kSpecies{
        make_beech(),          make_oak(),    make_birch(),   make_willow(),      make_poplar(),
        make_horse_chestnut(), make_apple(),  make_cherry(),  make_field_maple(), make_hawthorn(),
        make_hazel(),          make_olive(),  make_coconut(), make_fern(),        make_pine(),
        make_spruce(),         make_cypress()};
    return kSpecies;
}

std::optional<LeafSpecies> find_leaf_species(std::string_view name) {
    const auto found = std::ranges::find(leaf_species(), name, &LeafSpecies::name);
    if (found == leaf_species().end()) return std::nullopt;
    return *found;
}

}  // namespace coppice
