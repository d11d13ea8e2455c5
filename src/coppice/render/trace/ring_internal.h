#pragma once

#include "coppice/base/vec.h"
#include "coppice/render/image.h"

namespace coppice {

/// A circle in a picture, in pixels from its upper left corner.
struct Ring {
    float x, y;    ///< of the middle
    float radius;  ///< of the middle of the line
    float width;   ///< of the line
};

/// Draws a circle in linear colour over what is there; of one that lies partly outside, the part inside.
void draw_ring(Image& image, const Ring& ring, Vec3 color);

}  // namespace coppice
