#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/texture/cut_internal.h"

namespace coppice::texture_internal {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::uint64_t kRingStage = 100, kRayStage = 101, kCrackStage = 120;

/// Returns the difference of two angles in [-pi, pi].
float turn(float a, float b) { return std::remainder(a - b, 2 * kPi); }

}  // namespace

PolarNoise::PolarNoise(std::uint64_t seed, std::uint64_t stage, float waves, float length) {
    // The tile is twice as long as the radius, so that both ends of it differ.
    const Tile tile{1, 2, 1.0f / kColumns, 2.0f / kRows, seed};
    const Fractal noise(tile, 1 / waves, length, 4, stage);
    values_.resize(std::size_t{kColumns} * kRows);
    for (int row = 0; row < kRows; ++row) {
        noise.fill_row(static_cast<float>(row) / (kRows - 1),
                       std::span(values_).subspan(static_cast<std::size_t>(row) * kColumns, kColumns));
    }
}

float PolarNoise::operator()(float angle, float share) const {
    const float x = (angle / (2 * kPi) + 1) * kColumns, y = saturate(share) * (kRows - 1);
    const int i = round_down(x), j = std::min(round_down(y), kRows - 2);
    const auto value = [&](int column, int row) {
        return values_[static_cast<std::size_t>(row) * kColumns +
                       static_cast<std::size_t>(column % kColumns)];
    };
    const float u = x - static_cast<float>(i), v = y - static_cast<float>(j);
    return mix(mix(value(i, j), value(i + 1, j), u), mix(value(i, j + 1), value(i + 1, j + 1), u), v);
}

Rings::Rings(float radius, float width, std::uint64_t seed) : radius_(radius) {
    constexpr long kMaxRings = 100'000;
    const auto count = static_cast<std::size_t>(std::clamp(std::lround(radius / width), 1L, kMaxRings));
    const CounterRandom random(seed, kRingStage);
    borders_.push_back(0);
    float climate = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const float year = static_cast<float>(random.uniform(2 * k)) - 0.5f;
        climate = 0.7f * climate + 0.3f * year;
        // Young trees have wide rings; the widths of successive years are similar.
        const float age = static_cast<float>(k) / static_cast<float>(count);
        borders_.push_back(borders_.back() + (1.5f - 0.8f * age) * (1 + 0.9f * climate + 0.5f * year));
        tones_.push_back(static_cast<float>(random.uniform(2 * k + 1)));
    }
    for (float& border : borders_) border /= borders_.back();
    borders_.back() = 1;
    std::uint32_t ring = 0;
    for (std::size_t part = 0; part < 4 * count; ++part) {
        const float share = static_cast<float>(part) / static_cast<float>(4 * count);
        while (ring + 1 < count && borders_[ring + 1] <= share) ++ring;
        first_.push_back(ring);
    }
}

Rings::Ring Rings::at(float share) const {
    const auto parts = static_cast<float>(first_.size());
    const auto part = std::min(static_cast<std::size_t>(std::max(share, 0.0f) * parts), first_.size() - 1);
    std::size_t ring = first_[part];
    while (ring + 1 < tones_.size() && borders_[ring + 1] <= share) ++ring;
    const float width = borders_[ring + 1] - borders_[ring];
    return {saturate((share - borders_[ring]) / width), width * radius_, tones_[ring]};
}

Rays::Rays(const CutOptions& options, float radius, std::uint64_t seed) : amount_(options.rays) {
    constexpr int kMaxLayers = 12;
    // Each layer doubles the number of rays, where their distance has doubled.
    float begin = std::min(4 * options.ray_spacing, 0.25f * radius);
    for (int k = 0; k < kMaxLayers && begin < radius; ++k, begin *= 2) {
        const auto count =
            static_cast<std::size_t>(std::max(3.0f, std::round(kPi * begin / options.ray_spacing)));
        const CounterRandom random(seed, kRayStage + static_cast<std::uint64_t>(k));
        Layer layer{begin, {}, {}, {}};
        for (std::size_t i = 0; i < count; ++i) {
            const auto unit = [&](std::size_t at) { return static_cast<float>(random.uniform(4 * i + at)); };
            layer.angles.push_back(
                2 * kPi * (static_cast<float>(i) + 0.1f + 0.8f * unit(0)) / static_cast<float>(count) - kPi);
            layer.strengths.push_back(0.3f + 0.7f * unit(1));
            layer.ends.push_back(begin + (radius - begin) * (0.3f + unit(2)));
        }
        layers_.push_back(std::move(layer));
    }
}

float Rays::at(Polar p, float texel) const {
    constexpr float kHalfWidth = 0.00015f;  // [m] of wide rays
    float out = 0;
    const float width = std::max(kHalfWidth, 0.6f * texel);
    for (const Layer& layer : layers_) {
        const float begins = smooth_step(layer.begin, 1.4f * layer.begin, p.radius);
        if (begins == 0) break;
        const auto count = static_cast<int>(layer.angles.size());
        const int slot = round_down((p.angle + kPi) / (2 * kPi) * static_cast<float>(count));
        for (int k = slot - 1; k <= slot + 1; ++k) {
            const auto i = static_cast<std::size_t>((k % count + count) % count);
            const float across = p.radius * std::abs(turn(p.angle, layer.angles[i])) / width;
            if (across > 2 || p.radius > layer.ends[i]) continue;
            const float ends = smooth_step(0, 0.1f * layer.ends[i], layer.ends[i] - p.radius);
            out = std::max(out, begins * ends * layer.strengths[i] * (1 - smooth_step(0.3f, 2, across)));
        }
    }
    return amount_ * out * kHalfWidth / width;
}

Cracks::Cracks(const CutOptions& options, float radius, std::uint64_t seed) {
    constexpr std::size_t kOuter = 5, kInner = 4;
    const CounterRandom random(seed, kCrackStage);
    for (std::size_t i = 0; i < kOuter + kInner; ++i) {
        const auto unit = [&](std::size_t at) { return static_cast<float>(random.uniform(8 * i + at)); };
        if (unit(0) > options.cracks) continue;
        const float angle = 2 * kPi * unit(1) - kPi, length = radius * options.cracks;
        if (i < kOuter) {
            const float begin = radius - length * (0.25f + 0.7f * unit(2));
            cracks_.push_back({angle, begin, radius, 0.012f * radius * (0.3f + unit(3)), true});
        } else {
            cracks_.push_back(
                {angle, 0, length * (0.1f + 0.25f * unit(2)), 0.008f * radius * (0.3f + unit(3)), false});
        }
    }
}

float Cracks::at(Polar p, float wave, float texel) const {
    float out = 0;
    for (const Crack& crack : cracks_) {
        if (p.radius < crack.begin || p.radius > crack.end) continue;
        const float t = (p.radius - crack.begin) / (crack.end - crack.begin);
        const float half = 0.5f * crack.width * (crack.opens_outwards ? t : 1 - t);
        const float bend = 0.025f * wave * p.radius;
        const float across = std::abs(p.radius * std::sin(turn(p.angle, crack.angle)) + bend);
        if (std::abs(turn(p.angle, crack.angle)) > kPi / 2) continue;
        const float width = std::max(half, 0.5f * texel);
        out = std::max(out,
                       (1 - smooth_step(width - 0.5f * texel, width + 0.5f * texel, across)) * half / width);
    }
    return out;
}

}  // namespace coppice::texture_internal
