#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

/// Ridges along the stem between furrows that wander, cross and close, so that ridges split and merge; on
/// them, strips of fibres, and loose ones that peel off.
class Fibrous {
  public:
    explicit Fibrous(const BarkPlan& plan)
        : plan_(plan),
          s_(plan.spacing() * mix(0.4f, 1, std::min(plan.age, 1.0f))),
          long_(s_ * plan.options.stretch),
          left_(plan.tile, kRidge * s_, long_, 1),
          right_(plan.tile, 1.2f * kRidge * s_, long_, 2),
          strips_(plan.tile, 0.6f * s_, 0.8f * long_, 3),
          loose_(plan.tile, s_, 0.6f * long_, 4) {
        const Tile& t = plan.tile;
        const float ridge = kRidge * s_;
        noises_.emplace_back(t, 1.6f * ridge, 0.5f * long_, 2, 5, 0.4f);
        noises_.emplace_back(t, 1.6f * ridge, 0.5f * long_, 2, 6, 0.4f);
        noises_.emplace_back(t, ridge, 0.7f * long_, 3, 7);
        noises_.emplace_back(t, ridge, 0.7f * long_, 3, 8);
        noises_.emplace_back(t, 0.3f * s_, 0.4f * long_, 4, 9, 0.62f);
        noises_.emplace_back(t, 0.0018f, 0.06f, 3, 10, 0.7f);
        noises_.emplace_back(t, 2 * s_, 0.3f * long_, 4, 11, 0.55f);
        noises_.emplace_back(t, 0.0015f, 0.004f, 3, 12);
    }

    std::span<const Fractal> noises() const { return noises_; }

    BarkTexel operator()(Place p, const NoiseValues& n) const {
        const BarkOptions& o = plan_.options;
        const float fibre = n[kFibre], hair = n[kHair], wander = 0.4f * o.irregularity;
        const float edge = o.irregularity * (0.06f * fibre + 0.02f * hair);
        const Place left = left_.in_cells(p), right = right_.in_cells(p);
        const float furrow = std::max(find_furrow(left.x + wander * n[kWanderLeft], n[kOpenLeft], edge),
                                      find_furrow(right.x + wander * n[kWanderRight], n[kOpenRight], edge));
        // Strips follow the furrows, half those of each direction.
        const float shift = 0.5f * wander * kRidge * s_ * (n[kWanderLeft] + n[kWanderRight]);
        const Place q = p + Place{shift + 0.1f * o.irregularity * s_ * fibre, 0.12f * long_ * fibre};
        Layer top = make_strip(find_strip(strips_, q), n);
        add_loose(find_strip(loose_, q), n, top);
        const float ridge = 1 - saturate(plan_.age) * furrow;
        const float h = 0.7f * ridge + 0.3f * top.height + o.detail * (0.07f * fibre + 0.06f * hair);
        const float shade = (0.12f + 0.88f * smooth_step(0.05f, 0.75f, ridge)) * top.light;
        const Vec3 c = lerp(plan_.deep_color, color(top, ridge, n), shade);
        return {plan_.depth() * h + o.detail * 0.0001f * n[kGrain],
                c * (1 + 0.1f * fibre + 0.14f * hair + 0.05f * n[kGrain]), 0.04f * fibre + 0.03f * hair};
    }

  private:
    static constexpr float kRidge = 3.2f;  // [strips] width of a ridge
    enum { kWanderLeft, kWanderRight, kOpenLeft, kOpenRight, kFibre, kHair, kTone, kGrain };

    /// A place on a strip: [widths] across from its middle, [lengths] from its lower end.
    struct Strip {
        float across, along, texel;
        std::uint32_t id;
    };
    /// The outermost fibres at a place.
    struct Layer {
        float height, light, own;  // own: random number of the strip
    };

    /// Returns the depth of the furrow at the closest integer, from 0 to 1: it is narrow where `noise` is
    /// small, and closed at its pointed ends.
    static float find_furrow(float at, float noise, float edge) {
        const float distance = 0.5f - std::abs(at - std::floor(at) - 0.5f);
        const float open = saturate(0.55f + 0.9f * noise), dome = 1 - 2 * distance;
        const float width = 0.12f * open - 0.01f + edge * open;
        const float cut = 1 - smooth_step(0.45f * width, width + 0.02f, distance);
        return open * 0.35f * dome * dome + 0.65f * saturate(6 * open) * cut;
    }

    Strip find_strip(const Lattice& lattice, Place p) const {
        const Place c = lattice.in_cells(p);
        const int i = round_down(c.x);
        const std::uint64_t column =
            mix_bits(plan_.tile.seed << 32 ^ static_cast<std::uint64_t>(lattice.column(i)));
        const float y = c.y + static_cast<float>(column >> 40) * 0x1p-24f;
        const int j = round_down(y);
        const std::uint64_t id = mix_bits(column ^ static_cast<std::uint64_t>(lattice.row(j)));
        return {c.x - static_cast<float>(i) - 0.5f, y - static_cast<float>(j),
                plan_.tile.texel_width / lattice.cell().x, static_cast<std::uint32_t>(id)};
    }

    /// The strips below hang by one side; the other one is a crack.
    Layer make_strip(const Strip& strip, const NoiseValues& n) const {
        const float border = 0.5f - std::abs(strip.across) + 0.06f * n[kFibre];
        const float split = chance(strip.id, 0) * (1 - smooth_step(0, 0.14f + 2 * strip.texel, border));
        const float tilt = (chance(strip.id, 1) - 0.5f) * strip.across;
        return {0.5f * chance(strip.id, 2) + 0.8f * tilt - 0.5f * split, 1 - 0.55f * split,
                chance(strip.id, 3)};
    }

    /// Loose strips taper to torn ends, which rise above the bark.
    void add_loose(const Strip& strip, const NoiseValues& n, Layer& top) const {
        if (chance(strip.id, 0) > 0.6f) return;
        const float taper = smooth_step(0, 0.3f, std::min(strip.along, 1 - strip.along));
        const float half = (0.16f + 0.28f * chance(strip.id, 1)) * taper;
        const float middle = 0.1f * (chance(strip.id, 2) - 0.5f);
        const float soft = 0.03f + 1.2f * strip.texel;
        const float inside = half + 0.1f * n[kFibre] * taper - std::abs(strip.across - middle);
        const float on = smooth_step(-soft, soft, inside);
        const float lift =
            0.35f * std::abs(2 * strip.along - 1) + 0.6f * (chance(strip.id, 2) - 0.5f) * strip.across;
        top.height = mix(top.height, 0.75f + lift, on);
        const float shadow = 1 - 0.5f * (1 - on) * smooth_step(-0.12f - soft, -soft, inside) * taper;
        top.light = mix(top.light * shadow, 1, on);
        top.own = mix(top.own, 0.35f + 0.65f * chance(strip.id, 3), on);
    }

    /// Ridges are weathered, the more the looser their fibres.
    Vec3 color(const Layer& top, float ridge, const NoiseValues& n) const {
        const float pale = saturate(plan_.options.patches + 0.9f * (top.own - 0.5f) + 0.5f * n[kTone]);
        const Vec3 own = plan_.color + Vec3{0.1f, 0.05f, 0.03f} * (top.own - 0.5f);
        return lerp(own, plan_.patch_color, 0.85f * pale * smooth_step(0.35f, 0.95f, ridge)) *
               (0.9f + 0.15f * top.height);
    }

    const BarkPlan& plan_;
    float s_, long_;  // [m] width and length of a strip
    Lattice left_, right_, strips_, loose_;
    std::vector<Fractal> noises_;
};

}  // namespace

void fill_fibrous(const BarkPlan& plan, BarkCanvas& out, const Context& ctx) {
    fill(plan, Fibrous(plan), out, ctx);
}

}  // namespace coppice::texture_internal
