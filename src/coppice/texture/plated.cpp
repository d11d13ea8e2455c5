#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

constexpr float kThickness = 0.0009f;  // [m] thickness of a flake
constexpr float kLayers = 4.2f;        // layers of flakes from the border of a plate to its middle

/// Plates are cells; flakes are the terraces of a smooth thickness, which is largest inside a plate.
class Plated {
  public:
    explicit Plated(const BarkPlan& plan)
        : plan_(plan),
          s_(plan.spacing() * mix(0.3f, 1, std::min(plan.age, 1.0f))),
          long_(s_ * plan.options.stretch),
          plates_(plan.tile, s_, long_, 0.95f, 0.16f * s_, 1, 1) {
        const Tile& t = plan.tile;
        noises_.emplace_back(t, 1.6f * s_, 0.8f * long_, 2, 2);
        noises_.emplace_back(t, 0.4f * s_, 0.28f * long_, 3, 3);
        noises_.emplace_back(t, 0.5f * s_, 0.42f * long_, 4, 4, 0.45f);
        noises_.emplace_back(t, 0.002f, 0.003f, 4, 5, 0.65f);
        noises_.emplace_back(t, 0.003f, 0.02f, 3, 6);
        noises_.emplace_back(t, 0.09f, 0.13f, 4, 7);
    }

    std::span<const Fractal> noises() const { return noises_; }

    BarkTexel operator()(Place p, const NoiseValues& n) const {
        const BarkOptions& o = plan_.options;
        const float ripple = n[kRipple];
        const Place q = p + o.irregularity * s_ * Place{0.3f * n[kWander] + 0.12f * ripple, 0.22f * ripple};
        const Cell plate = plates_(q);
        const float gap = s_ * mix(0.02f, 0.075f, chance(plate.id ^ plate.next, 0)) * saturate(plan_.age);
        const float flake = n[kFlake], grain = n[kGrain], crease = n[kCrease];
        const float inside = plate.border - gap + 0.012f * s_ * flake;
        const float wall = smooth_step(0, 0.1f * s_ + plan_.tile.texel(), inside);
        // The bowl of the border becomes stairs.
        const float t =
            kLayers * (0.55f * saturate(inside / (0.38f * s_)) + 0.42f * flake) + 3 * chance(plate.id, 1) + 1;
        const float edge = std::min(0.5f, 0.07f + 4 * plan_.tile.texel() / s_);
        const float level = std::floor(t), rise = smooth_step(0, edge, t - level);
        const float stairs = level + rise + 0.12f * (t - level);
        const float tilt = 0.25f * (chance(plate.id, 2) - 0.5f) * plate.offset.x / s_ +
                           0.25f * (chance(plate.id, 3) - 0.5f) * plate.offset.y / long_;
        const float h = plan_.depth() * wall * (0.72f + 0.25f * (chance(plate.id, 0) - 0.5f) + tilt) +
                        wall * kThickness * saturate(plan_.age + 0.3f) * stairs +
                        o.detail * (0.00025f * grain + 0.00018f * crease + 0.0005f * (1 - wall) * grain);
        const float lip = rise * (1 - smooth_step(edge, edge + 0.25f, t - level));
        return {h, color(plate.id, level, rise, wall, lip, n),
                0.06f * (1 - wall) + 0.04f * grain - 0.03f * lip};
    }

  private:
    enum { kWander, kRipple, kFlake, kGrain, kCrease, kTone };

    static std::uint32_t flake_bits(std::uint32_t plate, float level) {
        return static_cast<std::uint32_t>(mix_bits(static_cast<std::uint64_t>(plate) << 8 |
                                                   static_cast<std::uint8_t>(static_cast<int>(level))));
    }

    Vec3 flake_color(std::uint32_t bits) const {
        const float pale = chance(bits, 0), red = chance(bits, 1) - 0.5f;
        return lerp(lerp(plan_.color, plan_.patch_color, 0.75f * pale * pale),
                    lerp(plan_.color, plan_.deep_color, 0.35f), chance(bits, 2) * 0.6f) +
               Vec3{0.05f, 0, -0.03f} * red;
    }

    Vec3 color(std::uint32_t plate, float level, float rise, float wall, float lip,
               const NoiseValues& n) const {
        const float tone = n[kTone], grain = n[kGrain], crease = n[kCrease];
        Vec3 c = lerp(flake_color(flake_bits(plate, level - 1)), flake_color(flake_bits(plate, level)), rise);
        c = lerp(c, plan_.patch_color, saturate(plan_.options.patches * (0.5f + tone)));
        c = c * (1 + 0.1f * tone + 0.1f * grain + 0.09f * crease + 0.1f * lip);
        const float edge_shade = 0.35f * (1 - rise);
        c = lerp(c, plan_.deep_color, edge_shade);
        const Vec3 gap = plan_.deep_color * (1 + 0.35f * grain);
        return lerp(gap, c, smooth_step(0.05f, 0.85f, wall));
    }

    const BarkPlan& plan_;
    float s_, long_;
    Cells plates_;
    std::vector<Fractal> noises_;
};

}  // namespace

void fill_plated(const BarkPlan& plan, BarkCanvas& out, const Context& ctx) {
    fill(plan, Plated(plan), out, ctx);
}

}  // namespace coppice::texture_internal
