#include "coppice/texture/bark.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/texture/bark_internal.h"

namespace coppice {
namespace texture_internal {

BarkCanvas::BarkCanvas(int width, int height, float tile_width, float tile_height) {
    const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    maps.width = width;
    maps.height = height;
    maps.tile_width = tile_width;
    maps.tile_height = tile_height;
    heights.resize(size);
    maps.color.resize(size);
    maps.normal.resize(size);
    maps.roughness.resize(size);
    maps.occlusion.resize(size);
    maps.heights.resize(size);
}

Vec3 choose_color(const std::optional<Vec3d>& given, unsigned otherwise, std::string_view owner,
                  std::string_view name) {
    if (!given) return rgb(otherwise);
    for (int k = 0; k < 3; ++k) {
        if (!((*given)[k] >= 0 && (*given)[k] <= 1))
            throw InvalidInput(fmt::format("{}: {} must have three values from 0 to 1, but has {}", owner,
                                           name, (*given)[k]));
    }
    return Vec3(*given);
}

}  // namespace texture_internal

namespace {

using namespace texture_internal;

constexpr int kMaxCells = 1000;  // along one side of a tile

struct KindColors {
    unsigned color, deep_color, patch_color;  // 0xrrggbb
};

/// The colours of a kind, where the options have none.
KindColors default_colors(BarkKind kind) {
    constexpr std::array<KindColors, 9> kColors{{
        {0x8c7f70, 0x32261d, 0x9a9f8a},  // furrowed
        {0x9c6a4a, 0x2b1a12, 0xb7a493},  // plated
        {0x8d7a6d, 0x4a2c1f, 0x9aa093},  // scaly
        {0x98917a, 0xe2d9bb, 0x6f6558},  // exfoliating
        {0xe6e0d6, 0xc79a78, 0x2c2622},  // lenticels
        {0x9c9a94, 0x73726c, 0xb2b4a9},  // smooth
        {0x8b5a42, 0x40231a, 0xa69688},  // fibrous
        {0x998d7d, 0x4a3d30, 0xb2ada0},  // ringed
        {0x7f9a45, 0x6a4a2c, 0xcfc79a},  // shoot
    }};
    return kColors[static_cast<std::size_t>(kind)];
}

void check_cells(float extent, float cell, std::string_view name) {
    if (extent <= kMaxCells * cell) return;
    throw InvalidInput(fmt::format(
        "bark: a tile with {} {:.4g} m has more than {} cells of the pattern, which have {:.4g} m; "
        "increase spacing or stretch, or reduce {}",
        name, extent, kMaxCells, cell, name));
}

/// Returns 0 for the diameter of a twig, a twelfth of the mature one, and 1 for the mature one.
float compute_age(const BarkOptions& o) {
    constexpr float kTwig = 12, kMaxAge = 1.2f;
    return std::clamp(1 + std::log(o.diameter / o.mature_diameter) / std::log(kTwig), 0.08f, kMaxAge);
}

BarkPlan make_plan(const BarkOptions& o) {
    check_fields(o, "bark");
    check_cells(o.tile_width, o.spacing, "tile_width");
    check_cells(o.tile_height, o.spacing * o.stretch, "tile_height");
    const KindColors colors = default_colors(o.kind);
    return {.options = o,
            .tile = {.width = o.tile_width,
                     .height = o.tile_height,
                     .texel_width = o.tile_width / static_cast<float>(o.width),
                     .texel_height = o.tile_height / static_cast<float>(o.height),
                     .seed = static_cast<std::uint64_t>(o.seed) * 16 + static_cast<std::uint64_t>(o.kind)},
            .age = compute_age(o),
            .color = choose_color(o.color, colors.color, "bark", "color"),
            .deep_color = choose_color(o.deep_color, colors.deep_color, "bark", "deep_color"),
            .patch_color = choose_color(o.patch_color, colors.patch_color, "bark", "patch_color")};
}

void fill_kind(const BarkPlan& plan, BarkCanvas& out, const Context& ctx) {
    constexpr std::array kFill{fill_furrowed, fill_plated,  fill_scaly,  fill_exfoliating, fill_lenticels,
                               fill_smooth,   fill_fibrous, fill_ringed, fill_shoot};
    kFill[static_cast<std::size_t>(plan.options.kind)](plan, out, ctx);
}

}  // namespace

void list_fields(BarkOptions& o, FieldList& list) {
    list.add(common_field("kind", "Pattern of the bark."), o.kind);
    list.add(common_field("width", "Number of pixels of the tile around the stem.", Unit::none, 1, 4096),
             o.width);
    list.add(common_field("height", "Number of pixels of the tile along the stem.", Unit::none, 1, 4096),
             o.height);
    list.add(common_field("tile_width", "Extent of the tile around the stem.", Unit::metre, 0.001, 10),
             o.tile_width);
    list.add(common_field("tile_height", "Extent of the tile along the stem.", Unit::metre, 0.001, 10),
             o.tile_height);
    list.add(
        common_field("diameter",
                     "Diameter of the stem: the bark of thin stems is smoother and finer than that of thick "
                     "ones.",
                     Unit::metre, 0.001, 10),
        o.diameter);
    list.add(
        Field{"mature_diameter", "Diameter of a stem with fully developed bark.", Unit::metre, 0.001, 10},
        o.mature_diameter);
    list.add(
        common_field("spacing", "Mean distance of ridges, plates, rings or lenticels.", Unit::metre, 1e-4, 1),
        o.spacing);
    list.add(
        Field{"stretch",
              "Length of ridges, plates or lenticels along the stem per width; of palms, the number of rings "
              "by which their spiral rises around the tile.",
              Unit::none, 0.02, 100},
        o.stretch);
    list.add(common_field("depth", "Height of fully developed ridges or plates.", Unit::metre, 0, 0.2),
             o.depth);
    list.add(Field{"irregularity", "Factor of all distortions of the pattern.", Unit::none, 0, 3},
             o.irregularity);
    list.add(Field{"detail", "Factor of the fine roughness of the surface.", Unit::none, 0, 3}, o.detail);
    list.add(Field{"patches", "Amount of lichen, scars, weathering or black patches.", Unit::none, 0, 1},
             o.patches);
    list.add(Field{"roughness", "Mean of the roughness map.", Unit::none, 0.05, 1}, o.roughness);
    list.add(Field{"occlusion_radius", "Maximum distance at which a ridge occludes its surroundings.",
                   Unit::metre, 1e-4, 1},
             o.occlusion_radius);
    list.add(Field{"color", "Colour of the outer surface in sRGB from 0 to 1; by default that of the kind."},
             o.color);
    list.add(Field{"deep_color", "Colour of furrows and inner layers in sRGB; by default that of the kind."},
             o.deep_color);
    list.add(
        Field{"patch_color", "Colour of lichen, lenticels and scars in sRGB; by default that of the kind."},
        o.patch_color);
    list.add(common_field("seed", "Seed of all random numbers.", Unit::none, 0, 2147483647), o.seed);
}

std::vector<BarkMaps::Texel> BarkMaps::packed() const {
    std::vector<Texel> out(size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = {occlusion[i], roughness[i], 0};
    return out;
}

BarkMaps make_bark(const BarkOptions& options, const Context& ctx) {
    const BarkPlan plan = make_plan(options);
    BarkCanvas canvas(options.width, options.height, options.tile_width, options.tile_height);
    fill_kind(plan, canvas, ctx);
    even_colors(canvas.maps, ctx);
    ctx.report(0.7f);
    derive_maps(canvas, options.occlusion_radius, ctx);
    ctx.report(1);
    return std::move(canvas.maps);
}

}  // namespace coppice
