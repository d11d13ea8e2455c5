#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

/// Scars of leaves around the stem, slightly slanted, with fissured bark between them.
class Ringed {
  public:
    explicit Ringed(const BarkPlan& plan)
        : plan_(plan),
          pitch_(plan.tile.height /
                 static_cast<float>(std::max(1L, std::lround(plan.tile.height / plan.spacing())))),
          spiral_(std::round(plan.options.stretch)),
          fissures_(plan.tile, 0.16f * pitch_, 1.5f * pitch_, 1, 0.01f * pitch_, 2, 1) {
        const Tile& t = plan.tile;
        noises_.emplace_back(t, 0.35f * t.width, 2.5f * pitch_, 3, 2, 0.45f);
        noises_.emplace_back(t, 0.3f * pitch_, 0.22f * pitch_, 4, 3, 0.6f);
        noises_.emplace_back(t, 0.22f * pitch_, 1.3f * pitch_, 4, 4, 0.6f);
        noises_.emplace_back(t, 0.0016f, 0.012f, 4, 5, 0.65f);
        noises_.emplace_back(t, 0.08f, 0.05f, 5, 6, 0.6f);
        noises_.emplace_back(t, 0.25f * t.width, 1.5f * pitch_, 3, 7);
    }

    std::span<const Fractal> noises() const { return noises_; }

    BarkTexel operator()(Place p, const NoiseValues& n) const {
        const BarkOptions& o = plan_.options;
        const float chip = n[kChip], own = saturate(0.5f + 0.7f * n[kSize]);
        // A whole number of rings more on the other side of the tile makes a spiral, as of successive leaves.
        const float at = p.y / pitch_ + spiral_ * p.x / plan_.tile.width +
                         o.irregularity * (0.22f * n[kWave] + 0.022f * chip);
        const float f = at - std::floor(at);
        const float size = 0.07f + 0.09f * own, texel = plan_.tile.texel_height / pitch_;
        // Above the lip, the scar; then bark that swells up to the next lip.
        const float scar = smooth_step(0.01f, 0.04f + texel, f) *
                           (1 - smooth_step(0.7f * size, 2.4f * size, f + 0.03f * chip));
        const float lip = smooth_step(0.72f + 0.1f * own, 0.95f, f) * (1 - smooth_step(0.97f - texel, 1, f));
        const float crack = crack_at(p, n, f, size);
        const float h = 0.5f * f * f * (0.6f + 0.5f * own) + (0.3f + 0.3f * own) * lip - 0.22f * scar -
                        0.3f * crack + 0.07f * chip + o.detail * (0.05f * n[kFibre] + 0.14f * n[kFissure]);
        return {plan_.depth() * h, color(f, scar, lip, crack, n), 0.06f * scar + 0.04f * n[kTone]};
    }

  private:
    enum { kWave, kChip, kFissure, kFibre, kTone, kSize };

    float crack_at(Place p, const NoiseValues& n, float f, float size) const {
        const Place q =
            p + plan_.options.irregularity * pitch_ * Place{0.05f * n[kFissure] + 0.02f * n[kChip], 0};
        const Cell cell = fissures_(q);
        const float open = smooth_step(0.72f, 1, chance(cell.id ^ cell.next, 0) + 0.3f * n[kTone]) *
                           smooth_step(size, 3 * size, f) * saturate(plan_.age);
        const float width = 0.018f * pitch_ * (0.6f + chance(cell.id, 1));
        return open * (1 - smooth_step(0.2f * width, width + plan_.tile.texel_width, cell.border));
    }

    Vec3 color(float f, float scar, float lip, float crack, const NoiseValues& n) const {
        const float tone = n[kTone];
        Vec3 c = lerp(plan_.color, plan_.deep_color, 0.3f * saturate(0.4f - tone) + 0.15f * (1 - f));
        const float lichen = plan_.options.patches * smooth_step(0.05f, 0.5f, tone + 0.3f * n[kChip] - 0.1f);
        c = lerp(c, plan_.patch_color, 0.7f * lichen);
        c = lerp(c, plan_.deep_color, saturate(0.6f * scar * (1 + 0.5f * n[kChip]) + 0.7f * crack));
        return c * (1 + 0.07f * lip + 0.1f * n[kFibre] + 0.1f * n[kFissure] + 0.06f * n[kChip]);
    }

    const BarkPlan& plan_;
    float pitch_;   // [m] distance of two rings
    float spiral_;  // number of rings by which the scars rise around the tile
    Cells fissures_;
    std::vector<Fractal> noises_;
};

}  // namespace

void fill_ringed(const BarkPlan& plan, BarkCanvas& out, const Context& ctx) {
    fill(plan, Ringed(plan), out, ctx);
}

}  // namespace coppice::texture_internal
