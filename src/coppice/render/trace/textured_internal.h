#pragma once

#include <cstdint>
#include <optional>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/render/material.h"
#include "coppice/render/trace/mip_map_internal.h"

namespace coppice {

/// Multiplies the channels of two colours.
constexpr Vec3 multiply(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// Texture coordinates at a hit, with their gradients in the plane of the face.
struct TexturePlace {
    float u = 0, v = 0;           ///< [tiles]
    Vec3 gradient_u, gradient_v;  ///< [tiles] per unit of the traced scene; zero for a face without area
};

/// Both sets of texture coordinates at a hit.
struct TexturePlaces {
    TexturePlace first, second;
    float weight = 0;            ///< of the second
    std::uint32_t material = 0;  ///< index of the material of the face
};

/// The part of the surface that one sample represents: its sides in the plane of the face.
struct Footprint {
    Vec3 right, down;
};

/// Values of a material at a place.
struct Texel {
    std::optional<Vec3> color;       ///< linear
    Vec3 normal;                     ///< unit, on the side of the given one
    std::optional<float> roughness;  ///< without: matt
    float occlusion = 1;             ///< fraction of the light of the sky that arrives
    float transmission = 0;          ///< transmitted light, relative to the reflected
};

/// A material with the levels of its images; refers to them.
class TracedMaterial {
  public:
    TracedMaterial(const RenderMaterial& material, const Context& ctx);

    /// Returns the values at a place. `normal` is the smoothed normal, around which the frame of the texture
    /// is orthonormal: u along the first axis, v on the side of the second.
    Texel at(const TexturePlace& place, const Footprint& footprint, Vec3 normal) const;
    /// Returns the values of both sets, interpolated by the weight.
    Texel at(const TexturePlaces& places, const Footprint& footprint, Vec3 normal) const;

  private:
    std::optional<MipMap> color_, normal_, roughness_, occlusion_;
    std::optional<Vec3> base_color_;
    float transmission_;
};

/// Light that a surface of the given roughness reflects as a dielectric, in addition to its diffuse colour.
struct Gloss {
    Vec3 normal, to_camera;  ///< unit
    float roughness;         ///< from 0 to 1

    /// Returns the reflected fraction of the light of a small source in the unit direction `to_light`,
    /// relative to that of a white matt surface, including the cosine: GGX [Walter2007].
    float of_source(Vec3 to_light) const;
    /// Returns the reflected fraction of the light of the sky [Schlick1994].
    float of_sky() const;
    /// Returns the direction from which most of it arrives, unit.
    Vec3 sky_direction() const;
};

}  // namespace coppice
