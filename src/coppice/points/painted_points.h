#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/points/point_set.h"

namespace coppice {

/// Red, green and blue, as sRGB has them.
using Rgb = std::array<std::uint8_t, 3>;

/// Points with what is known of each. A column holds a value for every point, or is empty where nothing is
/// known.
struct PaintedPoints {
    PointSet points;               ///< the points themselves
    std::vector<float> distances;  ///< [m] from a surface, negative behind it
    std::vector<Rgb> colors;       ///< of the points
    /// As LAS numbers them: 2 ground, 3 to 5 vegetation, 6 buildings, 7 and 18 noise, and so on.
    std::vector<std::uint8_t> classes = {};
    std::vector<float> intensities = {};            ///< of the echoes, in the file's own unit
    std::vector<std::uint8_t> return_numbers = {};  ///< which echo of its pulse a point is, from 1
    std::vector<std::uint8_t> return_counts = {};   ///< echoes of its pulse
};

/// Which columns of `PaintedPoints` are wanted; others take neither time nor memory.
struct PointColumns {
    bool distances = true;    ///< from a surface
    bool colors = true;       ///< of the points
    bool classes = true;      ///< by LAS
    bool intensities = true;  ///< of the echoes
    bool returns = true;      ///< numbers and counts
};

inline constexpr PointColumns kNoColumns{false, false, false, false, false};  ///< the places alone

}  // namespace coppice
