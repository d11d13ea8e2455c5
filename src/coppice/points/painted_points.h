#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/points/point_set.h"

namespace coppice {

/// Red, green and blue, as sRGB has them.
using Rgb = std::array<std::uint8_t, 3>;

/// Points with what is known of each, as a picture shows it.
struct PaintedPoints {
    PointSet points;               ///< the points themselves
    std::vector<float> distances;  ///< [m] of each from a surface, negative behind it; or none
    std::vector<Rgb> colors;       ///< of each; or none
};

}  // namespace coppice
