#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

/// Pale bark with dark lenticels across, skin that peels across, and black rough diamonds on old stems.
class Lenticels {
  public:
    explicit Lenticels(const BarkPlan& plan)
        : plan_(plan),
          s_(plan.spacing() * mix(0.35f, 1, std::min(plan.age, 1.0f))),
          tall_(s_ * plan.options.stretch),
          spots_(plan.tile, s_, tall_, 1, 0.1f * tall_, 1, 1),
          dots_(plan.tile, 0.4f * s_, 0.55f * tall_, 1, 0.1f * tall_, 2, 1),
          diamonds_(plan.tile, 0.26f, 0.32f, 0.75f, 0.01f, 3, 1) {
        const Tile& t = plan.tile;
        noises_.emplace_back(t, 3 * s_, 1.6f * tall_, 3, 4);
        noises_.emplace_back(t, 2.8f * s_, 1.1f * tall_, 5, 5, 0.55f);
        noises_.emplace_back(t, 0.5f * s_, 0.08f * tall_, 4, 6, 0.6f);
        noises_.emplace_back(t, 0.11f, 0.06f, 4, 7);
        noises_.emplace_back(t, 0.02f, 0.06f, 5, 8, 0.6f);
        noises_.emplace_back(t, 0.025f, 0.03f, 4, 9, 0.55f);
        noises_.emplace_back(t, 0.002f, 0.0016f, 3, 10);
    }

    std::span<const Fractal> noises() const { return noises_; }

    BarkTexel operator()(Place p, const NoiseValues& n) const {
        const BarkOptions& o = plan_.options;
        const float band = n[kBand], streak = n[kStreak], tone = n[kTone], grain = n[kGrain];
        const float wobble = n[kWobble];
        const Place q = p + o.irregularity * Place{0.0012f * wobble, 0.0006f * wobble + 0.0012f * tone};
        // Skin: the outer, white layer has holes and loose edges.
        const float soft = std::min(0.3f, 0.02f + 3.5f * plan_.tile.texel() / tall_);
        const float peel = n[kPeel] + 0.12f * tone;
        const float skin = 1 - smooth_step(0.62f - soft, 0.62f + soft, peel);
        const float curl = skin * smooth_step(0.62f - 6 * soft, 0.62f - soft, peel);
        Vec3 c = plan_.color * (1 + 0.05f * tone + 0.035f * streak) + Vec3{0.012f, 0, -0.012f} * band;
        const Vec3 inner = lerp(plan_.color, plan_.deep_color, 0.5f) * (1 + 0.1f * streak);
        c = lerp(inner, c, skin) * (1 + 0.03f * curl);
        float h = 0.35f * skin + 0.3f * curl + 0.1f * o.detail * streak + 0.25f * tone;
        const float spot = std::max(marks(spots_, q, 1, band), 0.8f * marks(dots_, q, 0.33f, -band));
        h += 0.5f * spot;
        c = lerp(c, plan_.patch_color * (1 + 0.2f * grain), 0.92f * spot);
        BarkTexel t{plan_.options.depth * (0.3f + 0.7f * plan_.age) * h + o.detail * 0.00003f * grain, c,
                    0.12f * spot + 0.05f * (1 - skin) + 0.03f * streak};
        add_diamond(p, n, t);
        return t;
    }

  private:
    enum { kBand, kPeel, kStreak, kTone, kRough, kWobble, kGrain };

    /// Returns 1 in the lenticels of a lattice.
    float marks(const Cells& cells, Place q, float size, float band) const {
        float found = 0;
        const float texel = plan_.tile.texel(), share = std::sqrt(size);
        cells.visit(q, 1, [&](Place d, std::uint32_t id) {
            const float amount = 0.42f + 0.5f * band * plan_.options.irregularity;
            if (chance(id, 0) > amount + 0.2f) return;
            const float present = saturate((amount + 0.2f - chance(id, 0)) * 5);
            const float width = std::max(0.055f * tall_ * (0.5f + chance(id, 2)) * share, 0.3f * texel);
            // Outside of the lens: the shift of its middle is at most 0.05 |d.x|.
            if (std::abs(d.y) > width + 0.8f * texel + 0.051f * std::abs(d.x)) return;
            const float c = chance(id, 1);
            const float length = s_ * size * (0.12f + 0.5f * c * c) * present;
            const float x = d.x / length;
            // Lens: thickest in the middle, with sharp ends.
            const float edge =
                width * saturate(1 - x * x) - std::abs(d.y + 0.1f * length * x * (chance(id, 3) - 0.5f));
            found = std::max(found, smooth_step(-0.7f * texel, 0.7f * texel + 0.25f * width, edge));
        });
        return found;
    }

    /// Blackish, fissured bark in diamonds around lost branches, with a dark brow to both sides.
    void add_diamond(Place p, const NoiseValues& n, BarkTexel& t) const {
        const float wobble = n[kWobble],
                    unit = std::min(diamonds_.cell_size().x, 1.3f * diamonds_.cell_size().y);
        float inside = -1, brow = 0;
        diamonds_.visit(p, 1, [&](Place d, std::uint32_t id) {
            if (chance(id, 0) >= 3 * plan_.options.patches * std::min(plan_.age, 1.0f)) return;
            const float size = unit * (0.1f + 0.12f * chance(id, 1));
            const float x = std::abs(d.x) / size;
            if (x >= 2 && wobble < 3) return;  // neither inside nor on the brow
            const float y = d.y / (size * (0.5f + 0.5f * chance(id, 2)));
            inside = std::max(inside, 1 - x - std::abs(y) + 0.3f * wobble);
            const float arc = (d.y - 0.35f * size) / size + 0.45f * x * x / (0.6f + x);
            const float line = std::abs(arc + 0.05f * wobble) - 0.1f * saturate(1.9f - x);
            brow = std::max(brow, (1 - smooth_step(-0.06f, 0.04f, line)) * (1 - smooth_step(1.1f, 2, x)));
        });
        const float black = std::max(smooth_step(-0.05f, 0.22f, inside), 0.8f * brow);
        if (black <= 0) return;
        const float rough = n[kRough], crack = 1 - smooth_step(0, 0.3f, std::abs(rough));
        const float core = smooth_step(0, 0.5f, inside);
        t.height += core * 0.006f * (0.55f - crack + 0.35f * rough) + black * 0.0007f * n[kGrain];
        const Vec3 dark = lerp(plan_.deep_color, plan_.patch_color, 0.75f + 0.25f * crack) *
                          (0.95f + 0.4f * rough * core + 0.15f * n[kGrain]);
        t.color = lerp(t.color, dark, saturate(black));
        t.roughness = mix(t.roughness, 0.22f, black);
    }

    const BarkPlan& plan_;
    float s_, tall_;
    Cells spots_, dots_, diamonds_;
    std::vector<Fractal> noises_;
};

}  // namespace

void fill_lenticels(const BarkPlan& plan, BarkCanvas& out, const Context& ctx) {
    fill(plan, Lenticels(plan), out, ctx);
}

}  // namespace coppice::texture_internal
