#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

/// Long strips of fibres, which are frayed into shreds with loose edges.
class Fibrous {
  public:
    explicit Fibrous(const BarkPlan& plan)
        : plan_(plan),
          s_(plan.spacing() * mix(0.4f, 1, std::min(plan.age, 1.0f))),
          long_(s_ * plan.options.stretch),
          strips_(plan.tile, 2.2f * s_, long_, 0.95f, 0.25f * s_, 1, 1),
          shreds_(plan.tile, 0.55f * s_, 0.7f * long_, 1, 0.1f * s_, 2, 1) {
        const Tile& t = plan.tile;
        noises_.emplace_back(t, 6 * s_, 0.6f * long_, 2, 3);
        noises_.emplace_back(t, 0.3f * s_, 0.4f * long_, 4, 4, 0.62f);
        noises_.emplace_back(t, 0.0018f, 0.06f, 3, 5, 0.7f);
        noises_.emplace_back(t, 4 * s_, 0.5f * long_, 4, 6, 0.55f);
        noises_.emplace_back(t, 0.0015f, 0.004f, 3, 7);
    }

    std::span<const Fractal> noises() const { return noises_; }

    BarkTexel operator()(Place p, const NoiseValues& n) const {
        const BarkOptions& o = plan_.options;
        const float fibre = n[kFibre], hair = n[kHair], texel = plan_.tile.texel();
        const Place q = p + o.irregularity * s_ * Place{0.8f * n[kWander] + 0.16f * fibre, 2.5f * fibre};
        const Cell strip = strips_(q), shred = shreds_(q);
        const float gap = s_ * 0.12f * chance(strip.id ^ strip.next, 0) * saturate(plan_.age);
        const float on = smooth_step(0, 0.4f * s_ + texel, strip.border - gap + 0.05f * s_ * fibre);
        const float split =
            chance(shred.id ^ shred.next, 0) * (1 - smooth_step(0, 0.1f * s_ + texel, shred.border));
        // Shreds are tilted about their length: one edge is loose.
        const float tilt = (chance(shred.id, 1) - 0.5f) * shred.offset.x / s_;
        const float h = 0.75f * on * (0.8f + 0.4f * (chance(strip.id, 1) - 0.5f)) +
                        0.3f * chance(shred.id, 2) + 0.6f * tilt - 0.2f * split +
                        o.detail * (0.2f * fibre + 0.1f * hair);
        return {plan_.depth() * h + o.detail * 0.00012f * n[kGrain],
                color(h, on, split, chance(shred.id, 3), n), 0.04f * fibre + 0.03f * hair};
    }

  private:
    enum { kWander, kFibre, kHair, kTone, kGrain };

    Vec3 color(float h, float on, float split, float own, const NoiseValues& n) const {
        const float fibre = n[kFibre], hair = n[kHair], tone = n[kTone];
        const float pale =
            saturate(plan_.options.patches + 0.3f * (own - 0.5f) + 0.55f * tone + 0.25f * fibre);
        Vec3 c = lerp(plan_.color, plan_.patch_color, 0.85f * pale * smooth_step(0.2f, 0.9f, h)) +
                 Vec3{0.1f, 0.06f, 0.035f} * (own - 0.5f);
        c = lerp(plan_.deep_color, c,
                 (0.55f + 0.45f * on) * (1 - 0.45f * split) * smooth_step(-0.5f, 0.3f, h));
        return c * (1 + 0.12f * fibre + 0.13f * hair + 0.08f * tone + 0.05f * n[kGrain]);
    }

    const BarkPlan& plan_;
    float s_, long_;  // [m] width and length of a strip
    Cells strips_, shreds_;
    std::vector<Fractal> noises_;
};

}  // namespace

void fill_fibrous(const BarkPlan& plan, BarkCanvas& out, const Context& ctx) {
    fill(plan, Fibrous(plan), out, ctx);
}

}  // namespace coppice::texture_internal
