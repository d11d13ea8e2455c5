#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

/// Smooth bark with folds across, lichen, and scars of lost branches: an eye under a brow.
class Smooth {
  public:
    explicit Smooth(const BarkPlan& plan)
        : plan_(plan),
          s_(plan.spacing()),
          scars_(plan.tile, 5 * s_, 4 * s_, 0.8f, 0.01f, 1, 1),
          dots_(plan.tile, 0.012f, 0.012f, 1, 0.001f, 2) {
        const Tile& t = plan.tile;
        noises_.emplace_back(t, 3 * s_, 3 * s_ * plan.options.stretch, 3, 3);
        noises_.emplace_back(t, 0.7f * s_, 0.7f * s_ * plan.options.stretch, 4, 4, 0.6f);
        noises_.emplace_back(t, 2.2f * s_, 2.6f * s_, 5, 5, 0.55f);
        noises_.emplace_back(t, 1.3f * s_, 1.3f * s_, 6, 6, 0.62f);
        noises_.emplace_back(t, 0.004f, 0.003f, 4, 7, 0.65f);
    }

    std::span<const Fractal> noises() const { return noises_; }

    BarkTexel operator()(Place p, const NoiseValues& n) const {
        const BarkOptions& o = plan_.options;
        const float swell = n[kSwell], fold = n[kFold], tone = n[kTone], grain = n[kGrain];
        const Place q = p + o.irregularity * 0.07f * s_ * Place{tone, fold};
        Vec3 c = lerp(plan_.color, plan_.deep_color, saturate(0.28f - 0.5f * tone - 0.12f * fold)) *
                 (1 + 0.03f * fold + 0.05f * grain);
        const float lichen = smooth_step(0.25f, 0.6f, n[kLichen] + 0.6f * (o.patches - 0.5f) + 0.1f * grain);
        c = lerp(c, plan_.patch_color * (1 + 0.06f * grain + 0.05f * tone), 0.45f * lichen);
        const float age = 0.4f + 0.6f * plan_.age;
        BarkTexel t{
            o.depth * age * (0.9f * swell + 0.35f * fold + 0.06f * lichen) + o.detail * 0.00006f * grain, c,
            0.12f * lichen + 0.03f * tone + 0.03f * grain};
        add_dots(p, t);
        add_scar(q, fold, grain, t);
        return t;
    }

  private:
    enum { kSwell, kFold, kTone, kLichen, kGrain };

    void add_dots(Place p, BarkTexel& t) const {
        float found = 0;
        dots_.visit(p, 1, [&](Place d, std::uint32_t id) {
            if (chance(id, 0) > 0.35f) return;
            const float r = std::sqrt(d.x * d.x + 4 * d.y * d.y), size = 0.0008f + 0.0012f * chance(id, 1);
            found = std::max(found, 1 - smooth_step(0.4f * size, size + plan_.tile.texel(), r));
        });
        t.height += 0.00015f * found;
        t.color = lerp(t.color, plan_.deep_color * 0.85f, 0.5f * found);
    }

    /// The scar grows with the stem: wide and flat on old ones.
    void add_scar(Place p, float fold, float grain, BarkTexel& t) const {
        scars_.visit(p, 1, [&](Place d, std::uint32_t id) {
            if (chance(id, 0) >= 0.3f + plan_.options.patches) return;
            const float size = std::min(s_, 0.2f * scars_.cell_size().x) * (0.4f + 0.35f * chance(id, 1));
            const float x = d.x / size, y = d.y / size;
            if (std::abs(x) > 2.6f || std::abs(y) > 2.6f) return;
            const float lean = 0.25f * (chance(id, 2) - 0.5f);
            // Eye: rings of callus around the closed wound.
            const float r = std::sqrt(x * x + 1.9f * y * y);
            const float ring = smooth_step(0.15f, 0.42f, r) * (1 - smooth_step(0.42f, 0.75f, r));
            const float pit = 1 - smooth_step(0.04f, 0.3f, r);
            // Brow: two arms from above the eye, down to both sides.
            const float arm = std::abs(x) * (1 + lean * x);
            const float line = std::abs(y - 0.7f + 0.5f * arm * arm / (0.55f + 0.5f * arm) + 0.03f * fold);
            const float thin = mix(0.1f, 0.03f, saturate(arm / 2.3f));
            const float fade = 1 - smooth_step(1.5f, 2.5f, arm);
            const float brow =
                (1 - smooth_step(0.3f * thin, thin + 1.5f * plan_.tile.texel() / size, line)) * fade;
            const float swelling = (1 - smooth_step(0, 0.45f, line)) * fade;
            const float dome = 1 - smooth_step(0, 1.5f, r);
            t.height += plan_.options.depth *
                        (1.6f * ring - 1.6f * pit - 1.2f * brow + 1.1f * swelling + 0.9f * dome);
            const Vec3 dark = lerp(plan_.deep_color, Vec3{0.13f, 0.12f, 0.11f}, 0.55f) * (1 + 0.2f * grain);
            t.color = lerp(t.color, dark, saturate(0.8f * brow + 0.6f * pit + 0.22f * ring));
            t.roughness += 0.12f * saturate(brow + pit);
        });
    }

    const BarkPlan& plan_;
    float s_;
    Cells scars_, dots_;
    std::vector<Fractal> noises_;
};

}  // namespace

void fill_smooth(const BarkPlan& plan, BarkCanvas& out, const Context& ctx) {
    fill(plan, Smooth(plan), out, ctx);
}

}  // namespace coppice::texture_internal
