#pragma once

#include <span>
#include <vector>

#include "coppice/points/point_cloud.h"

namespace coppice {

/// The relation between numbers and their colours.
enum class ValueScale {
    linear,       ///< from blue for the minimum to red for the maximum
    logarithmic,  ///< the same for the logarithm of numbers above 0
    numbers,      ///< whole numbers from 0, each with a colour of its own
};

/// Numbers as colours.
struct ValueColors {
    float min = 0;            ///< smallest number; 0 if all are unknown
    float max = 0;            ///< largest number; 0 if all are unknown
    std::vector<Rgb> colors;  ///< one per number
};

/// Returns the colour of a number between the minimum and the maximum; grey if it is not finite, or has no
/// logarithm. Equal bounds have the colour of the middle.
Rgb value_color(float value, float min, float max, ValueScale scale);

/// Returns the colours of numbers; those that are not finite, or have no logarithm, are unknown. O(n).
ValueColors value_colors(std::span<const float> values, ValueScale scale);

}  // namespace coppice
