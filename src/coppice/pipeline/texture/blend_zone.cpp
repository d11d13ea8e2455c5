#include "coppice/pipeline/texture/blend_zone_internal.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace coppice::pipeline_internal {
namespace {

// Maximum number of periods of waves around a rim; finer ones decrease together.
constexpr std::size_t kMaxWaves = 8;

// Returns the mean of the points of a closed curve.
TexturePoint mean_point(std::span<const TexturePoint> curve) {
    TexturePoint sum;
    for (const TexturePoint p : curve.first(curve.size() - 1)) sum = {sum.u + p.u, sum.v + p.v};
    const float share = 1 / static_cast<float>(curve.size() - 1);
    return {sum.u * share, sum.v * share};
}

// Returns whether a closed curve runs counter-clockwise around a point.
bool runs_around(std::span<const TexturePoint> curve, TexturePoint center) {
    for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
        const TexturePoint a = curve[k], b = curve[k + 1];
        const float area = (a.u - center.u) * (b.v - center.v) - (b.u - center.u) * (a.v - center.v);
        if (!(area > 0)) return false;
    }
    return true;
}

// Returns the first waves around a closed curve in the plane of complex numbers.
std::vector<BlendZone::Wave> find_waves(std::span<const TexturePoint> curve) {
    const std::size_t count = curve.size() - 1;
    std::vector<BlendZone::Wave> out(std::min<std::size_t>(kMaxWaves, (count - 1) / 2));
    const float share = 1 / static_cast<float>(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::complex<float> p(curve[i].u * share, curve[i].v * share);
        const std::complex<float> back =
            std::polar(1.0f, -2 * std::numbers::pi_v<float> * static_cast<float>(i) * share);
        std::complex<float> power = 1;
        for (BlendZone::Wave& wave : out) {
            power *= back;
            wave.forward += p * power;
            wave.backward += p * std::conj(power);
        }
    }
    return out;
}

}  // namespace

void BlendZone::set_rim(float v, std::vector<TexturePoint> rim) {
    const TexturePoint center = mean_point(rim);
    if (!runs_around(rim, center)) return;
    begin_ = v;
    center_ = center;
    waves_ = find_waves(rim);
    // The rest is the curve without these waves.
    const auto count = static_cast<float>(rim.size() - 1);
    for (std::size_t i = 0; i < rim.size(); ++i) {
        const TexturePoint smooth = sum_waves(static_cast<float>(i) / count, 1);
        rim[i] = {rim[i].u - center.u - smooth.u, rim[i].v - center.v - smooth.v};
    }
    rest_ = std::move(rim);
}

// Returns the sum of the waves at a place around the rim, each multiplied with a power of `decay`.
TexturePoint BlendZone::sum_waves(float turns, float decay) const {
    const Complex turn = std::polar(1.0f, 2 * std::numbers::pi_v<float> * turns);
    Complex power = 1, sum = 0;
    for (const Wave& wave : waves_) {
        power *= turn * decay;
        sum += wave.forward * power + wave.backward * std::conj(power);
    }
    return {sum.real(), sum.imag()};
}

// Returns the rest at a place around the rim.
TexturePoint BlendZone::rest_at(float turns) const {
    const auto count = static_cast<float>(rest_.size() - 1);
    const float place = (turns - std::floor(turns)) * count;
    const float begin = std::min(std::floor(place), count - 1);
    const auto k = static_cast<std::size_t>(begin);
    const float t = place - begin;
    return {std::lerp(rest_[k].u, rest_[k + 1].u, t), std::lerp(rest_[k].v, rest_[k + 1].v, t)};
}

TextureBlend BlendZone::at(TexturePoint first) const {
    if (waves_.empty() && ratio_ == 1) return {first, 0};
    const float along = first.v - begin_;
    const float length = std::min(wraps_ / std::numbers::pi_v<float>, max_v_ - begin_);
    const float t = length > 0 ? std::clamp(along / length, 0.0f, 1.0f) : 1.0f;
    const float weight = 1 - t * t * (3 - 2 * t);
    if (waves_.empty()) return {{first.u * ratio_, begin_ + along * ratio_}, weight};
    const float turns = first.u / wraps_;
    const float decay = std::exp(-2 * std::numbers::pi_v<float> * std::max(along, 0.0f) / wraps_);
    const TexturePoint smooth = sum_waves(turns, decay), rest = rest_at(turns);
    const float last = std::pow(decay, static_cast<float>(waves_.size() + 1));
    return {{center_.u + smooth.u + rest.u * last, center_.v + smooth.v + rest.v * last}, weight};
}

}  // namespace coppice::pipeline_internal
