#include "coppice/pipeline/texture/blend_zone_internal.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace coppice::pipeline_internal {
namespace {

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

}  // namespace

void BlendZone::set_rim(float v, std::vector<TexturePoint> rim, float density) {
    const TexturePoint center = mean_point(rim);
    if (!runs_around(rim, center)) return;
    begin_ = v;
    center_ = center;
    density_ = density;
    rim_ = std::move(rim);
}

TexturePoint BlendZone::rim_at(float turns) const {
    const auto count = static_cast<float>(rim_.size() - 1);
    const float place = (turns - std::floor(turns)) * count;
    const float begin = std::min(std::floor(place), count - 1);
    const auto k = static_cast<std::size_t>(begin);
    const float t = place - begin;
    return {std::lerp(rim_[k].u, rim_[k + 1].u, t), std::lerp(rim_[k].v, rim_[k + 1].v, t)};
}

TextureBlend BlendZone::at(TexturePoint first) const {
    if (rim_.empty() && ratio_ == 1) return {first, 0};
    const float along = first.v - begin_;
    const float max_length = std::min(wraps_ / std::numbers::pi_v<float>, max_v_ - begin_);
    const auto weight = [&](float length) {
        const float t = length > 0 ? std::clamp(along / length, 0.0f, 1.0f) : 1.0f;
        return 1 - t * t * (3 - 2 * t);
    };
    if (rim_.empty()) return {{first.u * ratio_, begin_ + along * ratio_}, weight(max_length)};
    const TexturePoint p = rim_at(first.u / wraps_);
    // The distance to the centre of the rim shrinks as fast along the lateral as around it, so that the
    // texture becomes larger but is not stretched, and keeps its direction across the rim.
    const float radius = density_ * std::hypot(p.u - center_.u, p.v - center_.v);
    const float scale = std::exp(-std::max(along, 0.0f) / radius);
    return {{center_.u + (p.u - center_.u) * scale, center_.v + (p.v - center_.v) * scale},
            weight(std::min(max_length, radius))};
}

}  // namespace coppice::pipeline_internal
