#include <algorithm>
#include <cmath>

#include "coppice/texture/bark.h"
#include "coppice/texture/bark_internal.h"

namespace coppice {
namespace {

using texture_internal::srgb;

std::vector<BarkSpecies> furrowed_species() {
    const BarkOptions oak;
    BarkOptions ash = oak;
    ash.spacing = 0.022f;
    ash.stretch = 4;
    ash.depth = 0.010f;
    ash.color = srgb(0x98938a);
    ash.deep_color = srgb(0x4a443c);
    ash.patch_color = srgb(0xa9ada0);
    BarkOptions willow = oak;
    willow.mature_diameter = willow.diameter = 0.7f;
    willow.spacing = 0.042f;
    willow.stretch = 4.5f;
    willow.depth = 0.022f;
    willow.irregularity = 1.4f;
    willow.color = srgb(0x8d8678);
    willow.deep_color = srgb(0x3d3227);
    BarkOptions poplar = oak;
    poplar.spacing = 0.05f;
    poplar.stretch = 6;
    poplar.depth = 0.025f;
    poplar.color = srgb(0x8a8780);
    poplar.deep_color = srgb(0x2e2a26);
    poplar.patch_color = srgb(0x9ba58a);
    return {{"oak", "oak: ridges broken into blocks", oak},
            {"ash", "ash: fine diamonds of grey ridges", ash},
            {"willow", "willow: wide ridges that join and part", willow},
            {"poplar", "black poplar: deep, long furrows", poplar}};
}

std::vector<BarkSpecies> plated_species() {
    const BarkOptions pine{.kind = BarkKind::plated,
                           .diameter = 0.45f,
                           .mature_diameter = 0.45f,
                           .spacing = 0.056f,
                           .stretch = 1.9f,
                           .depth = 0.014f,
                           .patches = 0.2f,
                           .roughness = 0.86f};
    BarkOptions larch = pine;
    larch.spacing = 0.038f;
    larch.stretch = 1.6f;
    larch.depth = 0.011f;
    larch.color = srgb(0x8b6353);
    larch.deep_color = srgb(0x3a2019);
    larch.patch_color = srgb(0xa8978c);
    return {{"pine", "Scots pine, lower stem: thick plates of flakes", pine},
            {"larch", "larch: small reddish plates", larch}};
}

std::vector<BarkSpecies> scaly_species() {
    const BarkOptions spruce{.kind = BarkKind::scaly,
                             .tile_width = 0.3f,
                             .tile_height = 0.3f,
                             .diameter = 0.4f,
                             .mature_diameter = 0.4f,
                             .spacing = 0.019f,
                             .stretch = 1.25f,
                             .depth = 0.0035f,
                             .patches = 0.35f,
                             .roughness = 0.84f,
                             .occlusion_radius = 0.01f};
    BarkOptions apple = spruce;
    apple.spacing = 0.026f;
    apple.stretch = 1.5f;
    apple.depth = 0.004f;
    apple.mature_diameter = apple.diameter = 0.25f;
    apple.color = srgb(0x8d8580);
    apple.deep_color = srgb(0x544238);
    apple.patch_color = srgb(0xa3aa8e);
    const BarkOptions plane{.kind = BarkKind::exfoliating,
                            .tile_width = 1,
                            .tile_height = 1,
                            .spacing = 0.085f,
                            .stretch = 1.3f,
                            .depth = 0.0035f,
                            .roughness = 0.68f,
                            .occlusion_radius = 0.006f};
    return {{"spruce", "Norway spruce: small round scales", spruce},
            {"apple", "apple: scales with lichen", apple},
            {"plane", "plane: patches of cream, olive and grey", plane}};
}

std::vector<BarkSpecies> smooth_species() {
    const BarkOptions birch{.kind = BarkKind::lenticels,
                            .tile_height = 1,
                            .diameter = 0.35f,
                            .mature_diameter = 0.35f,
                            .spacing = 0.05f,
                            .stretch = 0.32f,
                            .depth = 0.0009f,
                            .patches = 0.3f,
                            .roughness = 0.62f,
                            .occlusion_radius = 0.006f};
    BarkOptions cherry = birch;
    cherry.spacing = 0.06f;
    cherry.stretch = 0.3f;
    cherry.depth = 0.0012f;
    cherry.patches = 0;
    cherry.roughness = 0.5f;
    cherry.color = srgb(0x7a5148);
    cherry.deep_color = srgb(0x8f8078);
    cherry.patch_color = srgb(0x9c6f50);
    const BarkOptions beech{.kind = BarkKind::smooth,
                            .tile_width = 0.8f,
                            .tile_height = 0.8f,
                            .spacing = 0.06f,
                            .stretch = 0.22f,
                            .depth = 0.0022f,
                            .patches = 0.4f,
                            .roughness = 0.66f,
                            .occlusion_radius = 0.01f};
    return {{"birch", "silver birch: white, with lenticels and black diamonds", birch},
            {"cherry", "cherry: glossy red-brown, with bands of lenticels", cherry},
            {"beech", "beech: smooth and grey, with scars of branches", beech}};
}

std::vector<BarkSpecies> other_species() {
    const BarkOptions cedar{.kind = BarkKind::fibrous,
                            .tile_height = 1,
                            .spacing = 0.012f,
                            .stretch = 24,
                            .depth = 0.006f,
                            .patches = 0.3f,
                            .roughness = 0.9f,
                            .occlusion_radius = 0.01f};
    BarkOptions redwood = cedar;
    redwood.mature_diameter = redwood.diameter = 1.5f;
    redwood.tile_width = redwood.tile_height = 1;
    redwood.spacing = 0.032f;
    redwood.stretch = 18;
    redwood.depth = 0.03f;
    redwood.patches = 0.15f;
    redwood.color = srgb(0x9a5a3e);
    redwood.occlusion_radius = 0.03f;
    const BarkOptions palm{.kind = BarkKind::ringed,
                           .diameter = 0.3f,
                           .mature_diameter = 0.3f,
                           .spacing = 0.042f,
                           .stretch = 1,
                           .depth = 0.006f,
                           .roughness = 0.8f};
    const BarkOptions shoot{.kind = BarkKind::shoot,
                            .tile_width = 0.03f,
                            .tile_height = 0.06f,
                            .diameter = 0.01f,
                            .mature_diameter = 0.01f,
                            .spacing = 0.0016f,
                            .stretch = 12,
                            .depth = 0.0001f,
                            .roughness = 0.55f,
                            .occlusion_radius = 0.001f};
    return {{"cedar", "cedar: long strips of fibres", cedar},
            {"redwood", "coast redwood: thick fibrous ridges", redwood},
            {"palm", "palm: rings of leaf scars", palm},
            {"shoot", "green shoot with leaf scars", shoot}};
}

std::vector<BarkSpecies> make_species() {
    std::vector<BarkSpecies> all;
    for (const auto make : {furrowed_species, plated_species, scaly_species, smooth_species, other_species})
        for (const BarkSpecies& species : make()) all.push_back(species);
    return all;
}

}  // namespace

std::span<const BarkSpecies> bark_species() {
    static const std::vector<BarkSpecies> kSpecies = make_species();
    return kSpecies;
}

std::optional<BarkOptions> find_bark(std::string_view name) {
    for (const BarkSpecies& species : bark_species())
        if (species.name == name || name_of(species.options.kind) == name) return species.options;
    return std::nullopt;
}

void make_texels_square(BarkOptions& options, const BarkOptions& species, bool has_height,
                        bool has_tile_height) {
    if (has_height) {
        const float rows =
            static_cast<float>(options.height) / static_cast<float>(std::max(options.width, 1));
        if (!has_tile_height) options.tile_height = options.tile_width * rows;
        return;
    }
    if (!has_tile_height)
        options.tile_height = options.tile_width * (species.tile_height / species.tile_width);
    const double rows =
        static_cast<double>(options.width) * static_cast<double>(options.tile_height / options.tile_width);
    options.height = static_cast<int>(std::clamp(std::round(rows), 1.0, 4096.0));
}

}  // namespace coppice
