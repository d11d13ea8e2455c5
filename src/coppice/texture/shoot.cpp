#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

/// Green bark with striae along the shoot, dots of lenticels, and scars of leaves with a bud above.
class Shoot {
  public:
    explicit Shoot(const BarkPlan& plan)
        : plan_(plan),
          s_(plan.spacing()),
          dots_(plan.tile, s_, 1.7f * s_, 1, 0.1f * s_, 1, 1),
          scars_(plan.tile, 0.5f * plan.tile.width, 0.5f * plan.tile.height, 0.35f, 0.1f * s_, 2, 1) {
        const Tile& t = plan.tile;
        noises_.emplace_back(t, 0.35f * s_, 0.35f * s_ * plan.options.stretch, 4, 3, 0.6f);
        noises_.emplace_back(t, 4 * s_, 9 * s_, 4, 4);
        noises_.emplace_back(t, 0.08f * s_, 0.1f * s_, 3, 5);
        noises_.emplace_back(t, 0.6f * t.width, 0.7f * t.height, 3, 6);
    }

    std::span<const Fractal> noises() const { return noises_; }

    BarkTexel operator()(Place p, const NoiseValues& n) const {
        const BarkOptions& o = plan_.options;
        const float stria = n[kStria], tone = n[kTone], grain = n[kGrain];
        const float blush = smooth_step(0, 0.7f, n[kBlush] + 0.25f * tone + plan_.options.patches - 0.4f);
        Vec3 c = lerp(plan_.color, plan_.deep_color, 0.55f * blush + 0.18f * saturate(0.5f - stria));
        c = c * (1 + 0.07f * tone + 0.07f * stria + 0.03f * grain);
        BarkTexel t{o.depth * (0.55f * stria + 0.5f * tone) + o.detail * 0.000008f * grain, c,
                    0.04f * stria + 0.02f * grain};
        add_dots(p, t);
        add_scar(p, t);
        return t;
    }

  private:
    enum { kStria, kTone, kGrain, kBlush };

    void add_dots(Place p, BarkTexel& t) const {
        float found = 0;
        dots_.visit(p, 1, [&](Place d, std::uint32_t id) {
            if (chance(id, 0) > 0.45f) return;
            const float size = s_ * (0.07f + 0.1f * chance(id, 1));
            const float r = std::sqrt(d.x * d.x + 0.3f * d.y * d.y);
            found = std::max(found, 1 - smooth_step(0.5f * size, size + plan_.tile.texel(), r));
        });
        t.height += plan_.options.depth * 1.2f * found;
        t.color = lerp(t.color, plan_.patch_color, 0.75f * found);
        t.roughness += 0.1f * found;
    }

    /// A half-moon with three traces of vessels, and the bud above it.
    void add_scar(Place p, BarkTexel& t) const {
        scars_.visit(p, 1, [&](Place d, std::uint32_t id) {
            if (chance(id, 0) > 0.85f) return;
            const float size = 1.1f * s_ * (0.8f + 0.4f * chance(id, 1));
            const float x = d.x / size, y = d.y / size;
            const float r = std::sqrt(x * x + 1.7f * y * y);
            if (r > 4) return;
            const float soft = 2 * plan_.tile.texel() / size + 0.06f;
            const float moon =
                (1 - smooth_step(1 - soft, 1 + soft, r)) * smooth_step(-soft, soft, 0.2f + 0.25f * x * x - y);
            const float trace_x = std::abs(x) < 0.23f ? x : std::abs(x) - 0.46f;
            const float trace_r = std::sqrt(trace_x * trace_x + (y + 0.3f) * (y + 0.3f));
            const float trace = moon * (1 - smooth_step(0.04f, 0.14f + soft, trace_r));
            const float bud_r =
                std::sqrt(x * x * 2.2f + (y - 0.95f) * (y - 0.95f) * (y > 0.95f ? 0.8f : 1.8f));
            const float bud = 1 - smooth_step(0.2f, 0.85f, bud_r);
            const float cushion = 1 - smooth_step(0.3f, 2.6f, r);
            t.height += plan_.options.depth * (4.5f * cushion + 2 * moon - 1.5f * trace + 9 * bud);
            t.color = lerp(t.color, lerp(plan_.deep_color, plan_.patch_color, 0.45f), 0.7f * moon);
            t.color = lerp(t.color, plan_.deep_color * 0.7f, 0.8f * trace);
            t.color = lerp(t.color, lerp(plan_.deep_color, plan_.color, 0.25f) * (0.8f + 0.4f * saturate(y)),
                           0.85f * bud);
            t.roughness += 0.15f * moon;
        });
    }

    const BarkPlan& plan_;
    float s_;
    Cells dots_, scars_;
    std::vector<Fractal> noises_;
};

}  // namespace

void fill_shoot(const BarkPlan& plan, BarkCanvas& out, const Context& ctx) {
    fill(plan, Shoot(plan), out, ctx);
}

}  // namespace coppice::texture_internal
