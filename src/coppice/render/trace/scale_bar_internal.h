#pragma once

#include <string>

#include "coppice/render/image.h"

namespace coppice {

/// What stands beside the bar. Letters: digits, ".+-% mkun".
struct ScaleLabels {
    std::string top, middle, bottom;
};

/// From -number to +number.
ScaleLabels around_zero(const std::string& number);

/// Draws the key of the colours along the right side: a bar from blue (bottom) to red (top) with its labels.
/// Left out where the picture is too small to read it.
void draw_scale_bar(Image& image, const ScaleLabels& labels);

/// A length [m] with three digits, in the unit that keeps it between 1 and 1000 from nanometres to
/// kilometres: "1.25 mm".
std::string length_text(double length);

}  // namespace coppice
