#pragma once

#include <string>
#include <string_view>

#include "coppice/render/image.h"

namespace coppice {

/// Draws the key of the colours along the right side: a bar from -range (blue, bottom) to +range (red, top),
/// the range being written as `number`. Left out where the picture is too small to read it. Letters: digits,
/// ".+-% mkun".
void draw_scale_bar(Image& image, std::string_view number);

/// A length [m] with three digits, in the unit that keeps it between 1 and 1000 from nanometres to
/// kilometres: "1.25 mm".
std::string length_text(double length);

}  // namespace coppice
