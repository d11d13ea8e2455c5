#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/render/trace/textured_internal.h"

namespace coppice {
namespace {

constexpr float kReflectance = 0.04f;  // of dielectrics, perpendicular to the surface
constexpr float kMinRoughness = 0.2f;  // a narrower lobe than the sun would only be noise
constexpr float kMinOutward = 0.05f;   // of a normal in the frame of the texture

std::optional<MipMap> make_levels(const Image& image, TexelEncoding encoding, const Context& ctx) {
    if (image.pixels.empty()) return std::nullopt;
    return MipMap(image, encoding, ctx);
}

Vec3 value(const MipMap& map, const TexturePlace& p, const Footprint& f) {
    const float level = map.level(dot(p.gradient_u, f.right), dot(p.gradient_v, f.right),
                                  dot(p.gradient_u, f.down), dot(p.gradient_v, f.down));
    return map.sample(p.u, p.v, level);
}

/// Returns the normal of a texel in space; the smoothed normal if the texture has no direction there.
Vec3 turned(Vec3 encoded, const TexturePlace& p, Vec3 normal) {
    const Vec3 local = encoded * 2.0f - Vec3{1, 1, 1};
    Vec3 first = cross(p.gradient_v, normal);
    const float side = dot(first, p.gradient_u);
    if (!(std::abs(side) > 0)) return normal;
    first = normalized(first * (side < 0 ? -1.0f : 1.0f), Vec3{});
    Vec3 second = cross(normal, first);
    if (dot(second, p.gradient_v) < 0) second = -second;
    const Vec3 out = first * local.x + second * local.y + normal * std::max(local.z, kMinOutward);
    return normalized(out, normal);
}

float fifth(float x) { return x * x * x * x * x; }

}  // namespace

TracedMaterial::TracedMaterial(const RenderMaterial& material, const Context& ctx)
    : color_(make_levels(material.color, TexelEncoding::srgb, ctx)),
      normal_(make_levels(material.normal, TexelEncoding::linear, ctx)),
      roughness_(make_levels(material.roughness, TexelEncoding::linear, ctx)),
      occlusion_(make_levels(material.occlusion, TexelEncoding::linear, ctx)),
      base_color_(material.base_color),
      transmission_(material.transmission) {}

Texel TracedMaterial::at(const TexturePlace& place, const Footprint& footprint, Vec3 normal) const {
    Texel out;
    out.color = base_color_;
    if (color_) {
        const Vec3 color = value(*color_, place, footprint);
        out.color = base_color_ ? multiply(*base_color_, color) : color;
    }
    out.transmission = transmission_;
    out.normal = normal_ ? turned(value(*normal_, place, footprint), place, normal) : normal;
    if (roughness_) out.roughness = value(*roughness_, place, footprint).x;
    if (occlusion_) out.occlusion = value(*occlusion_, place, footprint).x;
    return out;
}

Texel TracedMaterial::at(const TexturePlaces& places, const Footprint& footprint, Vec3 normal) const {
    Texel out = at(places.first, footprint, normal);
    if (!(places.weight > 0)) return out;
    const Texel second = at(places.second, footprint, normal);
    const float t = places.weight;
    if (out.color) out.color = lerp(*out.color, *second.color, t);
    out.normal = normalized(lerp(out.normal, second.normal, t), normal);
    if (out.roughness) out.roughness = std::lerp(*out.roughness, *second.roughness, t);
    out.occlusion = std::lerp(out.occlusion, second.occlusion, t);
    return out;
}

float Gloss::of_source(Vec3 to_light) const {
    const float nl = dot(normal, to_light), nv = std::max(dot(normal, to_camera), 1e-3f);
    if (!(nl > 0)) return 0;
    const Vec3 half = normalized(to_light + to_camera, normal);
    const float nh = dot(normal, half), vh = std::max(dot(to_camera, half), 0.0f);
    const float a = std::max(roughness, kMinRoughness) * std::max(roughness, kMinRoughness);
    const float base = nh * nh * (a * a - 1) + 1;
    const float lobe = a * a / (std::numbers::pi_v<float> * base * base);
    const float shadow = 0.5f / std::lerp(2 * nl * nv, nl + nv, a);  // [Hammon2017]
    const float fresnel = kReflectance + (1 - kReflectance) * fifth(1 - vh);
    return std::numbers::pi_v<float> * lobe * shadow * fresnel * nl;
}

float Gloss::of_sky() const {
    const float nv = std::clamp(dot(normal, to_camera), 0.0f, 1.0f);
    return kReflectance + (std::max(1 - roughness, kReflectance) - kReflectance) * fifth(1 - nv);
}

Vec3 Gloss::sky_direction() const {
    const Vec3 mirrored = normal * (2 * dot(normal, to_camera)) - to_camera;
    return normalized(lerp(mirrored, normal, roughness * roughness), normal);
}

}  // namespace coppice
