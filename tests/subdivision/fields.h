#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>

#include "coppice/subdivision/project.h"

namespace coppice {

/// Any function of region and point as a field with level 1.
struct TestField {
    std::function<FieldSample(std::uint32_t, Vec3)> at;
    float level() const { return 1; }
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) out[i] = at(region, points[i]);
    }
};

/// The compact quartic kernel of an infinite line of radius 1 at the offset `away`: 1 at distance 1, 0
/// from 1.5 on.
inline FieldSample compact(Vec3 away) {
    constexpr float kSupport = 1.5f;
    constexpr float kScale = 1 / (1 - 1 / (kSupport * kSupport));
    const float d = length(away);
    const float base = std::max(0.0f, 1 - d * d / (kSupport * kSupport)) * kScale;
    const float slope = -2.5f * std::pow(base, 1.5f) * 2 * d / (kSupport * kSupport) * kScale;
    return {std::pow(base, 2.5f), normalized(away) * slope};
}

inline TestField cylinder_field() {
    return {[](std::uint32_t, Vec3 p) { return compact({p.x, p.y, 0}); }};
}
inline TestField sphere_field(Vec3 center = {}) {
    return {[center](std::uint32_t, Vec3 p) { return compact(p - center); }};
}

/// Values that no regular field returns.
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr std::array<FieldSample, 9> kNastySamples{
    {{kNan, {kNan, kNan, kNan}},
     {std::numeric_limits<float>::infinity(), {1, 0, 0}},
     {1e-38f, {1e-38f, 0, 0}},
     {1e38f, {1e38f, -1e38f, 0}},
     {2, {0, 0, 0}},
     {0.5f, {kNan, 0, 0}},
     {-3, {1, 1, 1}},
     {1, {0, 0, 0}},
     {0.5f, {1e-30f, 0, 0}}}};

/// Returns the k-th of them everywhere; for the index after the last, each of them somewhere.
inline TestField nasty_field(std::size_t k) {
    return {[k](std::uint32_t, Vec3 p) {
        const auto pick = static_cast<std::size_t>(std::abs(p.x + 2 * p.y) * 1000) % kNastySamples.size();
        return kNastySamples[k < kNastySamples.size() ? k : pick];
    }};
}

}  // namespace coppice
