#include "coppice/texture/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/texture/bark_internal.h"

namespace coppice {
namespace {

using namespace texture_internal;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kSamples = 4;  // along each side of a pixel
// The scene in radii: a ball on the left, a stem on the right, seen from the front.
constexpr Vec3 kBall{-1.12f, 0, 0};
constexpr Vec3 kStem{1.12f, 0, 0};
constexpr float kEye = 14;          // distance of the camera
constexpr float kHalfWidth = 2.3f;  // of the image in the plane of the axes
constexpr Vec3 kSun{-0.62f, 0.42f, 0.66f};
constexpr Vec3 kSunLight{2.55f, 2.4f, 2.15f};
constexpr Vec3 kFill{0.8f, 0.1f, 0.35f};
constexpr Vec3 kFillLight{0.3f, 0.34f, 0.42f};
constexpr Vec3 kSkyLight{0.42f, 0.46f, 0.52f};
constexpr Vec3 kGroundLight{0.2f, 0.18f, 0.16f};

struct Ray {
    Vec3 from, to;  // `to` is a unit vector
};

struct Hit {
    Vec3 normal, tangent, bitangent;  // tangents along u and v
    float u, v;                       // [tiles]
};

constexpr Vec3 multiply(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

class Scene {
  public:
    Scene(const BarkMaps& maps, float diameter)
        : maps_(maps),
          wraps_(std::max(1.0f, std::round(kPi * diameter / maps.tile_width))),
          // Scaled with the tiles around, so that the bark keeps its proportions.
          tiles_per_radius_(wraps_ * maps.tile_width / (2 * kPi * maps.tile_height)) {
        for (std::size_t i = 0; i < linear_.size(); ++i) {
            const float s = static_cast<float>(i) / 255;
            linear_[i] = s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
        }
    }

    /// Returns linear light.
    Vec3 trace(const Ray& ray) const {
        if (const auto hit = hit_ball(ray)) return shade(*hit, ray);
        if (const auto hit = hit_stem(ray)) return shade(*hit, ray);
        const float height = saturate(0.5f + 1.2f * ray.to.y);
        return lerp(Vec3{0.13f, 0.13f, 0.135f}, Vec3{0.3f, 0.31f, 0.33f}, height);
    }

  private:
    std::optional<Hit> hit_ball(const Ray& ray) const {
        const Vec3 o = ray.from - kBall;
        const float b = dot(o, ray.to), d = b * b - dot(o, o) + 1;
        if (d < 0) return std::nullopt;
        const Vec3 n = o + ray.to * (-b - std::sqrt(d));
        const float across = std::max(std::sqrt(n.x * n.x + n.z * n.z), 1e-4f);
        const Vec3 t{n.z / across, 0, -n.x / across};
        return Hit{n, t, cross(n, t), wraps_ * std::atan2(n.x, n.z) / (2 * kPi),
                   tiles_per_radius_ * std::asin(std::clamp(n.y, -1.0f, 1.0f))};
    }

    std::optional<Hit> hit_stem(const Ray& ray) const {
        const Vec3 o = ray.from - kStem;
        const float a = ray.to.x * ray.to.x + ray.to.z * ray.to.z, b = o.x * ray.to.x + o.z * ray.to.z;
        const float d = b * b - a * (o.x * o.x + o.z * o.z - 1);
        if (d < 0) return std::nullopt;
        const Vec3 p = o + ray.to * ((-b - std::sqrt(d)) / a);
        const Vec3 n{p.x, 0, p.z}, t{p.z, 0, -p.x};
        return Hit{n, t, {0, 1, 0}, wraps_ * std::atan2(n.x, n.z) / (2 * kPi), tiles_per_radius_ * p.y};
    }

    std::size_t texel_at(float u, float v) const {
        const auto column = static_cast<std::size_t>((u - std::floor(u)) * static_cast<float>(maps_.width));
        const auto row =
            static_cast<std::size_t>((1 - (v - std::floor(v))) * static_cast<float>(maps_.height));
        return std::min(row, static_cast<std::size_t>(maps_.height - 1)) *
                   static_cast<std::size_t>(maps_.width) +
               std::min(column, static_cast<std::size_t>(maps_.width - 1));
    }

    Vec3 shade(const Hit& hit, const Ray& ray) const {
        const std::size_t at = texel_at(hit.u, hit.v);
        const auto& c = maps_.color[at];
        const Vec3 albedo{linear_[c[0]], linear_[c[1]], linear_[c[2]]};
        const auto signed_byte = [](std::uint8_t b) { return static_cast<float>(b) / 127.5f - 1; };
        const auto& m = maps_.normal[at];
        const Vec3 n = normalized(hit.tangent * signed_byte(m[0]) + hit.bitangent * signed_byte(m[1]) +
                                  hit.normal * signed_byte(m[2]));
        const float open = static_cast<float>(maps_.occlusion[at]) / 255;
        const float rough = static_cast<float>(maps_.roughness[at]) / 255;
        const Vec3 sky = lerp(kGroundLight, kSkyLight, 0.5f + 0.5f * n.y) * open;
        Vec3 light = multiply(albedo, sky);
        for (const auto& [to, strength] : {std::pair{kSun, kSunLight}, std::pair{kFill, kFillLight}}) {
            const Vec3 l = normalized(to);
            // Light at a grazing angle does not reach the bottom of furrows.
            const float facing = std::max(dot(hit.normal, l), 0.0f);
            const float lit =
                std::max(dot(n, l), 0.0f) * smooth_step(0, 0.12f, facing) * mix(open * open, 1, facing);
            light += multiply(albedo * (1 / kPi) + glint(n, l, ray.to, rough), strength) * lit;
        }
        return light;
    }

    /// Specular reflection of a dielectric by the microfacets of [Walter2007].
    static Vec3 glint(Vec3 n, Vec3 l, Vec3 view, float rough) {
        const Vec3 h = normalized(l - view);
        const float a2 = std::pow(std::max(rough, 0.1f), 4.0f);
        const float c = std::max(dot(n, h), 0.0f), d = c * c * (a2 - 1) + 1;
        const float s = 0.04f * a2 / (kPi * d * d) * 0.25f;
        return {s, s, s};
    }

    const BarkMaps& maps_;
    float wraps_;
    float tiles_per_radius_;
    std::array<float, 256> linear_{};
};

std::uint8_t to_srgb_byte(float linear) {
    const float x = std::max(linear, 0.0f);
    // Bright parts are compressed, so that white bark keeps its shape.
    const float mapped = x < 0.6f ? x : 0.6f + 0.4f * (1 - std::exp(-(x - 0.6f) / 0.4f));
    return to_byte(mapped <= 0.0031308f ? 12.92f * mapped : 1.055f * std::pow(mapped, 1 / 2.4f) - 0.055f);
}

BarkMaps::Texel draw_pixel(const Scene& scene, float x, float y, float pixel) {
    Vec3 sum;
    for (int j = 0; j < kSamples; ++j) {
        for (int i = 0; i < kSamples; ++i) {
            const Vec3 to{x + pixel * (static_cast<float>(i) + 0.5f) / kSamples,
                          y - pixel * (static_cast<float>(j) + 0.5f) / kSamples, -kEye};
            sum += scene.trace({{0, 0, kEye}, normalized(to)});
        }
    }
    const Vec3 mean = sum * (1.0f / (kSamples * kSamples));
    return {to_srgb_byte(mean.x), to_srgb_byte(mean.y), to_srgb_byte(mean.z)};
}

}  // namespace

BarkPicture draw_bark(const BarkMaps& maps, float diameter, int width, int height, const Context& ctx) {
    constexpr int kMin = 16, kMax = 8192;
    if (maps.size() == 0) throw InvalidInput("a picture of bark requires maps of at least one texel");
    if (std::min(width, height) < kMin || std::max(width, height) > kMax)
        throw InvalidInput(
            "the width and the height of a picture of bark must be between 16 and 8192 pixels");
    if (!(diameter > 0)) throw InvalidInput("the diameter of the stem in a picture of bark must be above 0");
    const Scene scene(maps, diameter);
    BarkPicture out{width, height, {}};
    out.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const float pixel = 2 * kHalfWidth / static_cast<float>(width);
    parallel_for(ctx, static_cast<std::size_t>(height), 4, [&](std::size_t row) {
        const float y = pixel * (0.5f * static_cast<float>(height) - static_cast<float>(row));
        for (int i = 0; i < width; ++i) {
            out.pixels[row * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)] =
                draw_pixel(scene, pixel * static_cast<float>(i) - kHalfWidth, y, pixel);
        }
    });
    return out;
}

}  // namespace coppice
