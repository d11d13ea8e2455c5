#pragma once

#include <string>
#include <string_view>

#include "coppice/mesh/height_texture.h"

namespace coppice {

/// Returns the heights of a grey PNG of 16 bits, with the scale of its pCAL chunk if that is in metres, as
/// encode_png() writes it. `name` is that of the file, for messages. Throws InvalidInput for other files,
/// damaged ones, and images of more than 2^26 pixels.
HeightTexture decode_height_png(std::string_view bytes, const std::string& name);

}  // namespace coppice
