#pragma once

#include "coppice/render/image.h"

namespace coppice {

/// Draws the key of the deviation colours along the right side: a bar from -range (blue, bottom) to +range
/// (red, top) with its numbers in per cent. Left out where the picture is too small to read it.
void draw_scale_bar(Image& image, float range);

}  // namespace coppice
