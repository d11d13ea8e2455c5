#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

/// Ridges are stretched cells; furrows are their borders. Cracks across divide the ridges into blocks.
class Furrowed {
  public:
    explicit Furrowed(const BarkPlan& plan)
        : plan_(plan),
          s_(plan.spacing() * mix(0.45f, 1, std::min(plan.age, 1.0f))),
          long_(s_ * plan.options.stretch),
          ridges_(plan.tile, s_, long_, 0.9f, 0.2f * s_, 1, 1, 1),
          blocks_(plan.tile, 1.3f * s_, 0.9f * s_, 0.95f, 0.06f * s_, 2, 1) {
        const Tile& t = plan.tile;
        noises_.emplace_back(t, 2.6f * s_, 1.1f * long_, 2, 3);
        noises_.emplace_back(t, 0.6f * s_, 0.3f * long_, 3, 4, 0.55f);
        noises_.emplace_back(t, 2 * s_, 0.6f * long_, 2, 5);
        noises_.emplace_back(t, 0.14f * s_, 0.9f * s_, 4, 6, 0.62f);
        noises_.emplace_back(t, 0.0026f, 0.0032f, 4, 7, 0.65f);
        noises_.emplace_back(t, 0.05f, 0.07f, 5, 8, 0.6f);
        noises_.emplace_back(t, 0.35f * s_, 0.22f * s_, 4, 9, 0.55f);
    }

    std::span<const Fractal> noises() const { return noises_; }

    BarkTexel operator()(Place p, const NoiseValues& n) const {
        const BarkOptions& o = plan_.options;
        const Place warp{s_ * (0.5f * n[kWander] + 0.17f * n[kRipple] + 0.06f * n[kChip]),
                         0.3f * s_ * n[kRipple]};
        const Cell ridge = ridges_(p + o.irregularity * warp);
        const float fibre = n[kFibre], grain = n[kGrain], chip = n[kChip];
        // A slope of less than half a ridge leaves a flat top, which is the old surface of the stem.
        const float furrow = s_ * (0.015f + 0.045f * saturate(0.5f + n[kLift])) * std::min(plan_.age, 1.0f);
        const float slope = s_ * mix(0.1f, 0.3f, saturate(plan_.age));
        const float r = saturate((ridge.border + 0.035f * s_ * fibre - furrow) / slope);
        // Ledges: layers of cork of successive years.
        const float ledges = r + 0.06f * std::sin(19 * r + 3 * chip) * r * (1 - r) * 4;
        const float ridge_height =
            ledges * (2 - ledges) * (0.85f + 0.3f * (chance(ridge.id, 0) - 0.5f) + 0.2f * n[kLift]);
        const float crack = crack_at(p, n, r);
        const float rough = o.detail * (0.085f * fibre + 0.032f * grain + 0.1f * chip) * (0.5f + 0.5f * r);
        const float h = ridge_height * (1 - 0.5f * crack) + rough;
        return {plan_.depth() * h + o.detail * 0.0003f * grain, color(h, r, crack, n),
                0.05f * (1 - r) + 0.05f * n[kMottle] + 0.03f * grain};
    }

  private:
    enum { kWander, kRipple, kLift, kFibre, kGrain, kMottle, kChip };

    /// Returns the depth of a crack across a ridge, from 0 to 1.
    float crack_at(Place p, const NoiseValues& n, float r) const {
        const Place q = p + plan_.options.irregularity * s_ *
                                Place{0.15f * n[kRipple], 0.16f * n[kRipple] + 0.1f * n[kChip]};
        const Cell block = blocks_(q);
        const std::uint32_t both = block.id ^ block.next;
        const float width = s_ * mix(0.04f, 0.16f, chance(both, 1)) * saturate(plan_.age);
        const float open = smooth_step(0.3f, 0.8f, chance(both, 2) + 0.5f * (1 - r) + 0.35f * n[kLift]);
        return open *
               (1 - smooth_step(0, width + plan_.tile.texel(), block.border + 0.012f * s_ * n[kFibre]));
    }

    Vec3 color(float h, float r, float crack, const NoiseValues& n) const {
        const float mottle = n[kMottle], fibre = n[kFibre];
        const Vec3 middle = lerp(plan_.deep_color, plan_.color, 0.5f) + Vec3{0.035f, 0.008f, -0.012f};
        Vec3 c = lerp(plan_.deep_color, middle, smooth_step(-0.1f, 0.45f, h));
        c = lerp(c, plan_.color,
                 smooth_step(0.3f, 0.95f, h + 0.14f * mottle + 0.08f * fibre) * (1 - 0.6f * crack));
        const float lichen = plan_.options.patches *
                             smooth_step(0, 0.55f, mottle + 0.3f * n[kGrain] - 0.15f) *
                             smooth_step(0.4f, 0.9f, r);
        c = lerp(c, plan_.patch_color, 0.75f * lichen);
        return c * (1 + 0.13f * mottle * r + 0.16f * fibre + 0.11f * n[kGrain] + 0.06f * n[kChip]);
    }

    const BarkPlan& plan_;
    float s_, long_;  // [m] width and length of a ridge
    Cells ridges_, blocks_;
    std::vector<Fractal> noises_;
};

}  // namespace

void fill_furrowed(const BarkPlan& plan, BarkCanvas& out, const Context& ctx) {
    fill(plan, Furrowed(plan), out, ctx);
}

}  // namespace coppice::texture_internal
