#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/texture/bark.h"
#include "coppice/texture/lattice_internal.h"

namespace coppice::texture_internal {

/// The bark at one texel.
struct BarkTexel {
    float height;     ///< [m]
    Vec3 color;       ///< sRGB in [0, 1]; values outside are clamped
    float roughness;  ///< deviation from the mean
};

/// Input of the kinds.
struct BarkPlan {
    BarkOptions options;
    Tile tile;
    float age;  ///< 0 for a twig to 1 for mature bark, to 1.2 for old stems
    Vec3 color, deep_color, patch_color;

    float spacing() const { return options.spacing; }
    /// [m] depth at this age
    float depth() const { return options.depth * age; }
};

/// The heights [m] of a tile, and the maps that the kinds fill.
struct BarkCanvas {
    /// The maps have values for all texels of a tile [m].
    BarkCanvas(int width, int height, float tile_width, float tile_height);

    BarkMaps maps;
    std::vector<float> heights;
};

/// sRGB color from 0xrrggbb.
constexpr Vec3 rgb(unsigned hex) {
    constexpr float kUnit = 1.0f / 255;
    return {static_cast<float>(hex >> 16 & 255u) * kUnit, static_cast<float>(hex >> 8 & 255u) * kUnit,
            static_cast<float>(hex & 255u) * kUnit};
}

/// The same as the value of an option.
inline std::optional<Vec3d> srgb(unsigned hex) { return Vec3d(rgb(hex)); }

/// Returns a colour that is given by the option `name` of `owner`, "bark" or "cut", or else 0xrrggbb. Throws
/// InvalidInput for values outside of [0, 1].
Vec3 choose_color(const std::optional<Vec3d>& given, unsigned otherwise, std::string_view owner,
                  std::string_view name);

inline std::uint8_t to_byte(float x) {
    const float rounded = saturate(x) * 255 + 0.5f;
    return static_cast<std::uint8_t>(rounded);
}

/// The noises of a kind at one texel, by their index.
class NoiseValues {
  public:
    NoiseValues(const float* first, std::size_t stride) : first_(first), stride_(stride) {}
    float operator[](std::size_t k) const { return first_[k * stride_]; }

  private:
    const float* first_;
    std::size_t stride_;
};

/// Evaluates bark(place, noise values) at the centres of all texels, with the noises of bark.noises(), which
/// are computed by rows. `roughness`: the mean.
template <class Bark>
void fill(const Tile& tile, float roughness, const Bark& bark, BarkCanvas& out, const Context& ctx) {
    constexpr std::size_t kRows = 8;
    BarkMaps& maps = out.maps;
    const auto width = static_cast<std::size_t>(maps.width), height = static_cast<std::size_t>(maps.height);
    const std::span<const Fractal> noises = bark.noises();
    parallel_for_ranges(ctx, height, kRows, [&](IndexRange rows) {
        std::vector<float> values(noises.size() * width);
        for (std::size_t row = rows.begin; row < rows.end; ++row) {
            const float y = (static_cast<float>(height - 1 - row) + 0.5f) * tile.texel_height;
            for (std::size_t k = 0; k < noises.size(); ++k)
                noises[k].fill_row(y, std::span(values).subspan(k * width, width));
            for (std::size_t i = 0; i < width; ++i) {
                const Place p{(static_cast<float>(i) + 0.5f) * tile.texel_width, y};
                const BarkTexel t = bark(p, NoiseValues(values.data() + i, width));
                const std::size_t at = row * width + i;
                out.heights[at] = t.height;
                maps.color[at] = {to_byte(t.color.x), to_byte(t.color.y), to_byte(t.color.z)};
                maps.roughness[at] = to_byte(roughness + t.roughness);
            }
        }
    });
}

/// Evaluates a bark at the centres of all texels.
template <class Bark>
void fill(const BarkPlan& plan, const Bark& bark, BarkCanvas& out, const Context& ctx) {
    fill(plan.tile, plan.options.roughness, bark, out, ctx);
}

// The kinds: each evaluates its pattern for all texels.
void fill_furrowed(const BarkPlan& plan, BarkCanvas& out, const Context& ctx);
void fill_plated(const BarkPlan& plan, BarkCanvas& out, const Context& ctx);
void fill_scaly(const BarkPlan& plan, BarkCanvas& out, const Context& ctx);
void fill_exfoliating(const BarkPlan& plan, BarkCanvas& out, const Context& ctx);
void fill_lenticels(const BarkPlan& plan, BarkCanvas& out, const Context& ctx);
void fill_smooth(const BarkPlan& plan, BarkCanvas& out, const Context& ctx);
void fill_fibrous(const BarkPlan& plan, BarkCanvas& out, const Context& ctx);
void fill_ringed(const BarkPlan& plan, BarkCanvas& out, const Context& ctx);
void fill_shoot(const BarkPlan& plan, BarkCanvas& out, const Context& ctx);

/// Removes the variation of the colours over distances from a third of the tile to the whole tile: features
/// of this size occur once in a tile, and show each of its repetitions.
void even_colors(BarkMaps& maps, const Context& ctx);

/// Sets the range of the heights, and the maps of heights, normals and occlusion.
void derive_maps(BarkCanvas& canvas, float occlusion_radius, const Context& ctx);

}  // namespace coppice::texture_internal
