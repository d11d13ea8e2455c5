#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "coppice/points/point_cloud.h"

namespace coppice {

/// Returns the colour of a deviation: red for outside, blue for inside, pale grey for zero, another grey for
/// NaN; `t` is in [-1, 1]. Linear light.
Vec3 deviation_color(float t);

/// Encodes linear light in [0, 1] as sRGB.
float to_srgb(float linear);
/// The same for all three channels, as bytes. No channel may be negative.
Rgb to_srgb(Vec3 linear);
/// Decodes sRGB to linear light.
Vec3 to_linear(Rgb color);

/// Returns a colour for a number; the hues of consecutive numbers differ strongly.
Rgb numbered_color(std::size_t number);

/// Returns the size [m] below which 98 % of the distances are, as range of the colours, so that few large
/// ones do not make the others pale; above 0. Ignores values that are not finite. O(n).
float usual_range(std::span<const float> distances);

/// Returns the colour of each distance; those of size `range` have the full colour. O(n).
std::vector<Rgb> distance_colors(std::span<const float> distances, float range);

}  // namespace coppice
