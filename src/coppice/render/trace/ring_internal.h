#pragma once

#include "coppice/base/vec.h"
#include "coppice/render/image.h"

namespace coppice {

/// A circle in an image, in pixels from its upper left corner.
struct Ring {
    float x, y;    ///< of the centre
    float radius;  ///< of the centre of the line
    float width;   ///< of the line
};

/// Draws a circle in linear colour over the image; clips it at the border.
void draw_ring(Image& image, const Ring& ring, Vec3 color);

}  // namespace coppice
