#pragma once

#include "coppice/base/context.h"
#include "coppice/render/image.h"
#include "coppice/texture/bark.h"

namespace coppice::cli {

/// Draws a ball and a stem of the given diameter [m] with the bark, in an image of twice the height.
Image draw_bark(const BarkMaps& maps, float diameter, int width, const Context& ctx);

/// Draws a disc with a picture of cut wood, from the front.
Image draw_cut(const BarkMaps& maps, int width, const Context& ctx);

}  // namespace coppice::cli
