#pragma once

#include <string>
#include <string_view>

#include "coppice/render/image.h"

namespace coppice {

/// Decodes a PNG or JPEG file from its bytes; `name` is used in messages. Converts other colour spaces to
/// RGB; ignores the orientation stored by cameras (EXIF). Throws InvalidInput for other formats, damaged
/// files, and images of more than 128 million pixels.
Image decode_picture(std::string_view bytes, const std::string& name);

/// Composes `drawn` over an image of the same size, with its alpha scaled by `opacity` in [0, 1]. Throws
/// InvalidInput if the sizes differ.
Image overlay(const Image& picture, const Image& drawn, float opacity);

}  // namespace coppice
