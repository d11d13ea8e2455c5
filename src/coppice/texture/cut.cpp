#include "coppice/texture/cut.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/texture/bark_internal.h"
#include "coppice/texture/cut_internal.h"

namespace coppice {
namespace {

using namespace texture_internal;

/// A picture of cut wood, evaluated texel by texel.
class Cut {
  public:
    Cut(const CutOptions& o, const Tile& tile)
        : o_(o),
          radius_(0.5f * o.diameter),
          wood_(radius_ * (1 - o.bark_share)),
          texel_(tile.texel()),
          color_(choose_color(o.color, 0xc9a878, "cut", "color")),
          heart_color_(choose_color(o.heart_color, 0xa47a4c, "cut", "heart_color")),
          bark_color_(choose_color(o.bark_color, 0x54453a, "cut", "bark_color")),
          shape_(tile.seed, 1, 5, 0.35f),
          edge_(tile.seed, 2, 40, 0.15f),
          rings_(wood_, o.ring_width, tile.seed),
          rays_(o, wood_, tile.seed),
          cracks_(o, wood_, tile.seed) {
        noises_.emplace_back(tile, 0.3f * o.diameter, 0.3f * o.diameter, 4, 3);
        noises_.emplace_back(tile, 0.0012f, 0.0012f, 2, 4, 0.7f);
        noises_.emplace_back(tile, 0.02f * o.diameter, 0.005f, 4, 5, 0.6f);
        noises_.emplace_back(tile, 0.05f * o.diameter, 0.05f * o.diameter, 5, 6, 0.65f);
    }

    std::span<const Fractal> noises() const { return noises_; }

    BarkTexel operator()(Place p, const NoiseValues& n) const {
        const float x = p.x - radius_, y = p.y - radius_, r = std::hypot(x, y);
        const Polar at{r, std::atan2(y, x)};
        const float border = wood_ * (1 + 0.012f * o_.irregularity * edge_(at.angle, 0.5f));
        const float bark = smooth_step(border - 0.7f * texel_, border + 0.7f * texel_, r);
        const BarkTexel inside = bark < 1 ? wood(at, border, n) : BarkTexel{};
        const BarkTexel outside = bark > 0 ? rim(r, border, n) : BarkTexel{};
        return {mix(inside.height, outside.height, bark), lerp(inside.color, outside.color, bark),
                mix(inside.roughness, outside.roughness, bark)};
    }

  private:
    enum { kTone, kGrain, kSaw, kRough };

    BarkTexel wood(Polar at, float border, const NoiseValues& n) const {
        // The rings keep their order: the deviation grows along the radius, and is that of the bark at the
        // end.
        const float t = at.radius / border;
        const float moved = t + 0.045f * o_.irregularity * t * (1 - t) * shape_(at.angle, t);
        const Rings::Ring ring = rings_.at(std::max(moved, 0.0f));
        const float seen = o_.ring_contrast * saturate(ring.width / texel_ - 1.5f);
        // Late wood becomes denser up to the end of the ring; the early wood of the next begins at once.
        const float late = smooth_step(1 - o_.late_wood - 0.25f, 1 - 0.3f * o_.late_wood, ring.position) *
                           (1 - smooth_step(1 - texel_ / ring.width, 1, ring.position));
        const float early = 1 - smooth_step(0.1f, 0.35f + 0.2f * (1 - o_.late_wood), ring.position);
        const float pore = o_.pores * seen * early * smooth_step(0.15f, 0.6f, n[kGrain]);
        const float ray = rays_.at(at, texel_);
        const float crack = cracks_.at(at, shape_(at.angle + 1.7f, t), texel_);
        const float heart = 1 - smooth_step(o_.heartwood - 0.015f, o_.heartwood + 0.015f, moved);
        const float pith = 1 - smooth_step(0.5f, 1, at.radius / std::clamp(0.02f * wood_, 1e-4f, 0.003f));
        Vec3 c = lerp(color_, heart_color_, heart * (0.85f + 0.3f * n[kTone]));
        c = c * (1 + 0.06f * n[kTone] + 0.05f * o_.detail * n[kGrain] + 0.1f * (ring.tone - 0.5f));
        c = c * (1 - 0.38f * seen * late - 0.35f * pore);
        c = lerp(c, c * 1.18f, ray);
        c = lerp(c, c * 0.18f, std::max(crack, 0.6f * pith));
        const float saw = o_.detail * (0.00008f * n[kSaw] + 0.00005f * n[kGrain]);
        return {saw + 0.00015f * seen * late - 0.0002f * pore - 0.0015f * crack, c,
                0.05f * n[kGrain] - 0.1f * late + 0.1f * crack};
    }

    /// Inner bark is paler than outer bark, which is rough.
    BarkTexel rim(float r, float border, const NoiseValues& n) const {
        const float t = (r - border) / std::max(radius_ - border, texel_);
        const float inner = 1 - smooth_step(0.25f, 0.5f, t + 0.15f * n[kRough]);
        const float cambium = 1 - smooth_step(0, 0.1f, t);
        const float fissure = smooth_step(0.25f, 0.7f, n[kRough] + 0.5f * t - 0.25f);
        Vec3 c = lerp(bark_color_, lerp(bark_color_, heart_color_, 0.6f), inner);
        c = c * (1 + 0.15f * n[kRough] + 0.1f * o_.detail * n[kGrain]);
        c = lerp(c, c * 0.45f, std::max(0.7f * cambium, 0.8f * fissure * (1 - inner)));
        return {0.0004f * o_.detail * n[kRough] - 0.001f * fissure * (1 - inner) - 0.0003f * cambium, c,
                0.1f + 0.05f * n[kRough]};
    }

    const CutOptions& o_;
    float radius_, wood_, texel_;  // [m]
    Vec3 color_, heart_color_, bark_color_;
    PolarNoise shape_, edge_;
    Rings rings_;
    Rays rays_;
    Cracks cracks_;
    std::vector<Fractal> noises_;
};

}  // namespace

void list_fields(CutOptions& o, FieldList& list) {
    list.add(Field{"size", "Width and height of the picture of a cut in pixels.", Unit::none, 16, 4096},
             o.size);
    list.add(common_field("diameter", "Diameter of the cut, bark included.", Unit::metre, 0.005, 5),
             o.diameter);
    list.add(common_field("ring_width", "Mean width of an annual ring.", Unit::metre, 1e-4, 0.1),
             o.ring_width);
    list.add(Field{"ring_contrast", "Difference of early and late wood.", Unit::none, 0, 1}, o.ring_contrast);
    list.add(Field{"late_wood", "Share of late wood in a ring.", Unit::none, 0.02, 0.98}, o.late_wood);
    list.add(Field{"pores", "Amount of pores in the early wood.", Unit::none, 0, 1}, o.pores);
    list.add(Field{"rays", "Visibility of the rays.", Unit::none, 0, 1}, o.rays);
    list.add(Field{"ray_spacing", "Mean distance of visible rays.", Unit::metre, 1e-4, 1}, o.ray_spacing);
    list.add(Field{"heartwood", "Share of heartwood in the radius of the wood.", Unit::none, 0, 1},
             o.heartwood);
    list.add(Field{"bark_share", "Share of bark in the radius.", Unit::none, 0, 0.5}, o.bark_share);
    list.add(Field{"cracks", "Amount of cracks by drying.", Unit::none, 0, 1}, o.cracks);
    list.add(Field{"irregularity", "Factor of the deviations of rings from circles.", Unit::none, 0, 3},
             o.irregularity);
    list.add(Field{"detail", "Factor of the fine roughness of the surface.", Unit::none, 0, 3}, o.detail);
    list.add(Field{"roughness", "Mean of the roughness map.", Unit::none, 0.05, 1}, o.roughness);
    list.add(Field{"color", "Colour of sapwood in sRGB from 0 to 1; by default that of an oak."}, o.color);
    list.add(Field{"heart_color", "Colour of heartwood in sRGB; by default that of an oak."}, o.heart_color);
    list.add(Field{"bark_color", "Colour of bark in sRGB; by default that of an oak."}, o.bark_color);
    list.add(common_field("seed", "Seed of all random numbers.", Unit::none, 0, 2147483647), o.seed);
}

std::optional<CutOptions> find_cut(std::string_view name) {
    for (const CutSpecies& species : cut_species()) {
        if (species.name == name) return species.options;
    }
    return std::nullopt;
}

BarkMaps make_cut(const CutOptions& options, const Context& ctx) {
    constexpr float kOcclusionRadius = 0.004f;         // [m]
    constexpr std::uint64_t kSeeds = 16, kStage = 15;  // barks have the stages below
    check_fields(options, "cut");
    BarkCanvas canvas(options.size, options.size, options.diameter, options.diameter);
    const float texel = options.diameter / static_cast<float>(options.size);
    const Tile tile{options.diameter, options.diameter, texel, texel,
                    static_cast<std::uint64_t>(options.seed) * kSeeds + kStage};
    fill(tile, options.roughness, Cut(options, tile), canvas, ctx);
    ctx.report(0.7f);
    derive_maps(canvas, kOcclusionRadius, ctx);
    ctx.report(1);
    return std::move(canvas.maps);
}

}  // namespace coppice
