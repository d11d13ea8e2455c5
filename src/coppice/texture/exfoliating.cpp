#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

/// Places from which flakes have fallen off, in random order: each shows the bark below the flake, which is
/// the paler the later the flake fell. Their outlines are unions of discs, so that the remaining bark has the
/// shapes of a jigsaw.
class Exfoliating {
  public:
    explicit Exfoliating(const BarkPlan& plan)
        : plan_(plan),
          s_(plan.spacing()),
          tall_(s_ * plan.options.stretch),
          flakes_(plan.tile, s_, tall_, 0.8f, 0.1f * s_, 1, 0.5f),
          chips_(plan.tile, 0.4f * s_, 0.4f * tall_, 0.8f, 0.1f * s_, 2, 0.5f) {
        const Tile& t = plan.tile;
        noises_.emplace_back(t, 0.42f * s_, 0.42f * tall_, 4, 3, 0.48f);
        noises_.emplace_back(t, 0.42f * s_, 0.42f * tall_, 4, 4, 0.48f);
        noises_.emplace_back(t, 0.45f * s_, 0.6f * tall_, 4, 5, 0.5f);
        noises_.emplace_back(t, 0.25f * s_, 0.3f * tall_, 4, 6, 0.6f);
        noises_.emplace_back(t, 0.003f, 0.003f, 3, 7, 0.7f);
        noises_.emplace_back(t, 0.7f * s_, 0.5f * tall_, 3, 8);
    }

    std::span<const Fractal> noises() const { return noises_; }

    BarkTexel operator()(Place p, const NoiseValues& n) const {
        const BarkOptions& o = plan_.options;
        const Place q = p + o.irregularity * s_ * Place{0.13f * n[kWarpAcross], 0.13f * n[kWarpAlong]};
        Fallen fallen;
        add_fallen(flakes_, q, 0.1f, fallen);
        add_fallen(chips_, q, 0.6f, fallen);
        std::ranges::sort(fallen.begin(), fallen.end(), {}, &Flake::id);
        // Thin layers within a flake come off one by one.
        const float steps = 2.2f * n[kLayer], level = std::floor(steps);
        const float soft = std::min(0.5f, 0.06f + 5 * plan_.tile.texel() / s_);
        const float thin = 0.07f * (level + smooth_step(0, soft, steps - level));
        Surface top{0, patch_color(0) * (1 + 0.25f * thin), 1.15f};
        for (const Flake& flake : fallen) remove_flake(flake, thin, top);
        const float tone = 0.06f * n[kTone] + 0.045f * n[kGrain];
        const float age = 0.35f + 0.65f * std::min(plan_.age, 1.2f);
        const float h =
            0.5f * o.depth * age * (top.height + 0.35f * n[kWave]) + o.detail * 0.00007f * n[kGrain];
        return {h, top.color * (1 + tone), 0.1f * (0.5f - top.time) + 0.03f * n[kGrain]};
    }

  private:
    static constexpr float kReach = 1.4f;  // [radii] of the lobes of a flake
    enum { kWarpAcross, kWarpAlong, kLayer, kTone, kGrain, kWave };
    /// A place without a flake: [m] the distance inside of its outline, or minus that outside. Flakes fell in
    /// the order of their ids.
    struct Flake {
        float inside;
        std::uint32_t id;
        float time() const { return static_cast<float>(id >> 16) * (1.0f / 65536); }
    };
    class Fallen {
      public:
        void add(Flake flake) { all_[size_++] = flake; }
        Flake* begin() { return all_.data(); }
        Flake* end() { return all_.data() + size_; }

      private:
        std::array<Flake, 18> all_;  // of two lattices, 3 x 3 cells each
        std::size_t size_ = 0;
    };
    struct Surface {
        float time;  // when the last flake fell, from 0 to 1
        Vec3 color;
        float height;  // [layers]
    };

    float rim() const { return 0.05f * s_; }

    void add_fallen(const Cells& cells, Place q, float spared, Fallen& out) const {
        constexpr float kMaxRadius = 0.64f;  // [cells] so that its lobes end within the next cell
        const Place size = cells.cell_size();
        const float scale = 0.85f + 0.5f * plan_.options.patches;
        cells.visit(q, 1, [&](Place d, std::uint32_t id) {
            if (chance(id, 2) < spared) return;
            const float r = size.x * std::min(scale * (0.3f + 0.32f * chance(id, 0)), kMaxRadius);
            const Place at{d.x, d.y * size.x / size.y};
            const float reach = kReach * r + rim();
            if (dot(at, at) > reach * reach) return;
            const float inside = find_inside(at, r, id);
            if (inside > -rim()) out.add({inside, id});
        });
    }

    /// Returns the distance inside of the union of a disc and three smaller ones around it.
    static float find_inside(Place at, float r, std::uint32_t id) {
        const auto distance = [&](Place center) {
            const Place d = at - center;
            return std::sqrt(dot(d, d));
        };
        float inside = r - distance({0, 0});
        const float angle = 6.2831853f * chance(id, 1);
        Place lobe{0.72f * r * std::cos(angle), 0.72f * r * std::sin(angle)};
        for (unsigned k = 0; k < 3; ++k) {
            inside = std::max(inside, r * (0.42f + 0.25f * chance(id, k)) - distance(lobe));
            lobe = {-0.5f * lobe.x - 0.866f * lobe.y, 0.866f * lobe.x - 0.5f * lobe.y};  // by 120 degrees
        }
        return inside;
    }

    void remove_flake(const Flake& flake, float thin, Surface& top) const {
        const float soft = 0.8f * plan_.tile.texel() + 0.003f * s_, time = flake.time();
        const float bare = smooth_step(-soft, soft, flake.inside);
        const float step = saturate(4 * (time - top.time));
        // The flakes around it curl at their edges, which are torn and brown.
        const float curl = saturate(1 + flake.inside / rim());
        top.height += 0.3f * step * curl * curl * (1 - bare);
        const float torn = 1 - smooth_step(0, 0.008f * s_ + soft, std::abs(flake.inside + soft));
        const float shown = saturate(time + thin);
        top.height = mix(top.height, 1 - shown, bare);
        top.color = lerp(top.color, patch_color(0.1f + 0.9f * shown * std::sqrt(shown)), bare);
        top.color = lerp(top.color, plan_.patch_color * 0.62f, 0.4f * step * torn);
        top.time = mix(top.time, time, bare);
    }

    /// Returns the colour of bark from which a flake fell at a time: from grey over olive to cream.
    Vec3 patch_color(float time) const {
        const Vec3 olive = lerp(plan_.patch_color, plan_.color, 0.5f) + Vec3{-0.02f, 0.005f, -0.06f};
        const std::array<Vec3, 5> colors{plan_.patch_color, lerp(plan_.patch_color, plan_.color, 0.7f), olive,
                                         lerp(plan_.color, plan_.deep_color, 0.45f), plan_.deep_color};
        const float at = std::min(time * 4, 3.999f), first = std::floor(at);
        const auto k = static_cast<std::size_t>(first);
        return lerp(colors[k], colors[k + 1], at - first);
    }

    const BarkPlan& plan_;
    float s_, tall_;  // [m] width and height of a flake
    Cells flakes_, chips_;
    std::vector<Fractal> noises_;
};

}  // namespace

void fill_exfoliating(const BarkPlan& plan, BarkCanvas& out, const Context& ctx) {
    fill(plan, Exfoliating(plan), out, ctx);
}

}  // namespace coppice::texture_internal
