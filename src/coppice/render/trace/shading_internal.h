#pragma once

#include <cstdint>
#include <span>

#include "coppice/render/colors.h"
#include "coppice/render/trace/traced_scene_internal.h"

namespace coppice {

/// Linear light, premultiplied by alpha.
struct Light {
    Vec3 color;
    float alpha = 0;
};

/// Colour of marks: a magenta that occurs on no surface. Linear.
constexpr Vec3 kMarkColor{0.80f, 0.0f, 0.42f};

/// Sun, sky and the reflection of the surface.
class Shading {
  public:
    /// Faces with the index of none of the `materials` have no material.
    Shading(const TracedScene& scene, const Camera& camera, const RenderOptions& options,
            std::span<const TracedMaterial> materials);

    /// Returns the light of pixel (x, y), the mean of all samples. Does not depend on earlier calls.
    Light pixel(int x, int y) const;

  private:
    struct Draws;    // the random numbers of one sample
    struct Surface;  // the properties of a visible place

    Light sample(float x, float y, const Draws& draws) const;
    Light marked(Vec3 origin, Vec3 direction, const std::optional<Hit>& front) const;
    Light solid(const Hit& hit, const Camera::Ray& ray, float x, float y, const Draws& draws) const;
    Surface surface(const Hit& hit, const Camera::Ray& ray, float x, float y) const;
    Footprint footprint(const Hit& hit, const Camera::Ray& ray, float x, float y) const;
    Light ground(Vec3 origin, Vec3 direction, const Draws& draws) const;
    std::optional<Vec3> evidence_color(const Hit& hit) const;  ///< nullopt if not requested
    Vec3 albedo(const Hit& hit) const;
    float wire(const Hit& hit, float x, float y) const;
    Vec3 sun_direction(const Draws& draws) const;

    const TracedScene& scene_;
    const Camera& camera_;
    const RenderOptions& options_;
    std::span<const TracedMaterial> materials_;
    Vec3 sun_;
    float ground_height_;
    bool ground_visible_;
};

}  // namespace coppice
