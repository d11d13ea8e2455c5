#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

/// Round scales, each on a random level, with lifted edges: the upper envelope of the scales at a place.
class Scaly {
  public:
    explicit Scaly(const BarkPlan& plan)
        : plan_(plan),
          s_(plan.spacing() * mix(0.4f, 1, std::min(plan.age, 1.0f))),
          tall_(s_ * plan.options.stretch),
          scales_(plan.tile, s_, tall_, 0.8f, 0.1f * s_, 1, 0.5f),
          small_(plan.tile, 0.55f * s_, 0.55f * tall_, 0.8f, 0.1f * s_, 2, 0.5f) {
        const Tile& t = plan.tile;
        noises_.emplace_back(t, 0.8f * s_, 0.8f * tall_, 3, 3);
        noises_.emplace_back(t, 0.8f * s_, 0.8f * tall_, 3, 4);
        noises_.emplace_back(t, 0.0022f, 0.0026f, 4, 5, 0.65f);
        noises_.emplace_back(t, 0.07f, 0.1f, 4, 6);
        noises_.emplace_back(t, 0.3f * s_, 0.3f * tall_, 3, 7, 0.6f);
    }

    std::span<const Fractal> noises() const { return noises_; }

    BarkTexel operator()(Place p, const NoiseValues& n) const {
        const BarkOptions& o = plan_.options;
        const Place q = p + o.irregularity * 0.2f * s_ * Place{n[kWarpAcross], n[kWarpAlong]};
        const float edge = n[kEdge], grain = n[kGrain], tone = n[kTone];
        Top top{0.12f + 0.1f * edge, plan_.deep_color * (1 + 0.2f * grain)};
        add_scales(small_, q, 0.55f, 0.35f, edge, top);
        add_scales(scales_, q, 1, 1, edge, top);
        const float h = plan_.depth() * top.height + o.detail * (0.00022f * grain);
        const float lichen = o.patches * smooth_step(0.1f, 0.55f, tone + 0.3f * grain - 0.2f) *
                             smooth_step(0.3f, 0.8f, top.height);
        const Vec3 c = lerp(top.color, plan_.patch_color, 0.75f * lichen);
        return {h, c * (1 + 0.12f * tone + 0.12f * grain), 0.05f * tone + 0.04f * grain};
    }

  private:
    enum { kWarpAcross, kWarpAlong, kGrain, kTone, kEdge };
    struct Top {
        float height;  // [depths]
        Vec3 color;
    };

    void add_scales(const Cells& scales, Place q, float size, float raise, float edge, Top& top) const {
        const float radius = 0.62f * s_ * size, ratio = s_ / tall_;
        const float soft = 1.5f * plan_.tile.texel() + 0.012f * s_;
        scales.visit(q, 1, [&](Place d, std::uint32_t id) {
            const float r = std::min(
                radius * (0.75f + 0.42f * chance(id, 0)) * (1 + 0.2f * plan_.options.irregularity * edge),
                0.95f * size * s_ - soft);
            const float along = d.y * ratio;
            const float distance = std::sqrt(d.x * d.x + along * along);
            if (distance > r + soft) return;
            const float t = distance / r;
            const float tilt = 0.18f * ((chance(id, 1) - 0.5f) * d.x + (chance(id, 2) - 0.7f) * d.y) / r;
            const float face = raise * (0.25f + 0.5f * chance(id, 3)) + tilt + 0.3f * t * t * t;
            const float mask = 1 - smooth_step(r - soft, r + soft, distance);
            cover(top, face, mask, id, t);
        });
    }

    void cover(Top& top, float face, float mask, std::uint32_t id, float t) const {
        constexpr float kSoft = 0.05f;
        const float above = saturate(0.5f + 0.5f * (face - top.height) / kSoft) * mask;
        const float pale = chance(id, 2);
        Vec3 c = lerp(lerp(plan_.deep_color, plan_.color, 0.5f + 0.4f * pale), plan_.color, t * t * t) +
                 Vec3{0.05f, 0.01f, -0.02f} * (chance(id, 1) - 0.5f);
        c = c * (0.92f + 0.2f * pale);
        top.height = mix(top.height, face, above);
        top.color = lerp(top.color, c, above);
    }

    const BarkPlan& plan_;
    float s_, tall_;
    Cells scales_, small_;
    std::vector<Fractal> noises_;
};

}  // namespace

void fill_scaly(const BarkPlan& plan, BarkCanvas& out, const Context& ctx) {
    fill(plan, Scaly(plan), out, ctx);
}

}  // namespace coppice::texture_internal
