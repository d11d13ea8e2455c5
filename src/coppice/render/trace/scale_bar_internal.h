#pragma once

#include <string>

#include "coppice/render/image.h"

namespace coppice {

/// Labels of the bar. Supported characters: digits, ".+-% mkun".
struct ScaleLabels {
    std::string top, middle, bottom;
};

/// Returns labels from -number to +number.
ScaleLabels around_zero(const std::string& number);

/// Draws the colour scale on the right side: a bar from blue (bottom) to red (top) with its labels. Omitted
/// if the image is too small.
void draw_scale_bar(Image& image, const ScaleLabels& labels);

/// Formats a length [m] with three digits, in the unit from nanometres to kilometres that keeps it between 1
/// and 1000: "1.25 mm".
std::string length_text(double length);

}  // namespace coppice
