#pragma once

#include <cstdint>

#include "coppice/render/colors.h"
#include "coppice/render/trace/traced_scene_internal.h"

namespace coppice {

/// Linear light, premultiplied by alpha.
struct Light {
    Vec3 color;
    float alpha = 0;
};

/// Of what is marked: a magenta that no surface has. Linear.
constexpr Vec3 kMarkColor{0.80f, 0.0f, 0.42f};

/// Sun, sky and what the surface makes of them.
class Shading {
  public:
    Shading(const TracedScene& scene, const Camera& camera, const RenderOptions& options);

    /// The light of pixel (x, y), the mean of all samples. The same whatever is asked before.
    Light pixel(int x, int y) const;

  private:
    struct Draws;  // the random numbers of one sample

    Light sample(float x, float y, const Draws& draws) const;
    Light marked(Vec3 origin, Vec3 direction, const std::optional<Hit>& front) const;
    Light solid(const Hit& hit, float x, float y, const Draws& draws) const;
    Light ground(Vec3 origin, Vec3 direction, const Draws& draws) const;
    std::optional<Vec3> evidence_color(const Hit& hit) const;  ///< none where it is not asked for
    Vec3 albedo(const Hit& hit) const;
    float wire(const Hit& hit, float x, float y) const;
    Vec3 sun_direction(const Draws& draws) const;

    const TracedScene& scene_;
    const Camera& camera_;
    const RenderOptions& options_;
    Vec3 sun_;
    float ground_height_;
    bool ground_visible_;
};

}  // namespace coppice
