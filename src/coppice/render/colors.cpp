#include "coppice/render/colors.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/srgb.h"

namespace coppice {
namespace {

constexpr Vec3 kUnknown{0.25f, 0.25f, 0.25f};
constexpr double kUsual = 0.98;     // fraction of the distances within the range of the colours
constexpr float kMinRange = 1e-9f;  // [m]

}  // namespace

Vec3 deviation_color(float t) {
    static constexpr std::array<Vec3, 5> kStops{Vec3{0.02f, 0.08f, 0.50f}, Vec3{0.14f, 0.38f, 0.75f},
                                                Vec3{0.72f, 0.72f, 0.70f}, Vec3{0.80f, 0.28f, 0.12f},
                                                Vec3{0.50f, 0.02f, 0.02f}};
    if (std::isnan(t)) return kUnknown;
    const float at = (std::clamp(t, -1.0f, 1.0f) + 1) * 2;
    const auto i = std::min<std::size_t>(3, static_cast<std::size_t>(at));
    return lerp(kStops[i], kStops[i + 1], at - static_cast<float>(i));
}

float to_srgb(float linear) {
    const float x = std::clamp(linear, 0.0f, 1.0f);
    return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

Rgb to_srgb(Vec3 linear) {
    const auto byte = [](float x) { return static_cast<std::uint8_t>(std::lround(255 * to_srgb(x))); };
    return {byte(linear.x), byte(linear.y), byte(linear.z)};
}

Vec3 to_linear(Rgb color) {
    const auto light = [](std::uint8_t byte) { return decode_srgb(static_cast<float>(byte) / 255); };
    return {light(color[0]), light(color[1]), light(color[2])};
}

Rgb numbered_color(std::size_t number) {
    const double hue = 6 * std::fmod(0.13 + 0.618034 * static_cast<double>(number), 1.0);
    const double light = number % 3 == 0 ? 0.95 : number % 3 == 1 ? 0.75 : 0.6;
    const auto part = [&](double shift) {
        const double t = std::fmod(hue + shift, 6.0);
        const double full = std::clamp(std::min(t, 4 - t), 0.0, 1.0);
        return static_cast<std::uint8_t>(std::lround(255 * light * (0.2 + 0.8 * full)));
    };
    return {part(2), part(0), part(4)};
}

float usual_range(std::span<const float> distances) {
    std::vector<float> sizes;
    sizes.reserve(distances.size());
    for (const float d : distances)
        if (std::isfinite(d)) sizes.push_back(std::fabs(d));
    if (sizes.empty()) return kMinRange;
    const auto at =
        sizes.begin() + static_cast<std::ptrdiff_t>(kUsual * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), at, sizes.end());
    return std::max(*at, kMinRange);
}

std::vector<Rgb> distance_colors(std::span<const float> distances, float range) {
    std::vector<Rgb> out;
    out.reserve(distances.size());
    for (const float d : distances) out.push_back(to_srgb(deviation_color(d / range)));
    return out;
}

}  // namespace coppice
