#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/texture/bark.h"

namespace coppice {

/// An opaque image of 8 bits per channel, in sRGB. Row 0 is at the top.
struct BarkPicture {
    int width = 0;                        ///< [pixels]
    int height = 0;                       ///< [pixels]
    std::vector<BarkMaps::Texel> pixels;  ///< width * height, row by row
};

/// Returns a picture of a ball and a stem of this diameter [m] with the bark, in sun and sky light. The tile
/// is repeated a whole number of times around both. Each pixel is the mean of 4 x 4 rays.
///
/// Cost: 2 microseconds of CPU time per pixel. Throws InvalidInput if there are no maps, width or height is
/// not in [16, 8192], or the diameter is not above 0; Cancelled.
BarkPicture draw_bark(const BarkMaps& maps, float diameter, int width, int height, const Context& ctx = {});

}  // namespace coppice
