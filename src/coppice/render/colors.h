#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "coppice/points/painted_points.h"

namespace coppice {

/// Red for outside, blue for inside, pale grey for true, a grey of its own for what is not a number; `t` runs
/// over [-1, 1]. Linear light.
Vec3 deviation_color(float t);

/// Encodes linear light in [0, 1] as sRGB.
float to_srgb(float linear);
/// The same for all three, as bytes. No colour is below 0.
Rgb to_srgb(Vec3 linear);
/// Back again.
Vec3 to_linear(Rgb color);

/// A colour for each of many things: those of neighbouring numbers are far apart in hue.
Rgb numbered_color(std::size_t number);

/// The size [m] that 98 % of the distances keep below, so that few far away do not pale the others when it is
/// drawn in full colour; above 0. What is not finite does not count. O(n).
float usual_range(std::span<const float> distances);

/// The colour of each distance where `range` has the full colour. O(n).
std::vector<Rgb> distance_colors(std::span<const float> distances, float range);

}  // namespace coppice
