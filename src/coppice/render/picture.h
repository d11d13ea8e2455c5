#pragma once

#include <string>
#include <string_view>

#include "coppice/render/image.h"

namespace coppice {

/// The picture in the bytes of a PNG or JPEG file, whichever they are; `name` names it in messages. Of other
/// colours than RGB it makes RGB; what cameras say of how it is to be turned (EXIF) is passed over. Throws
/// InvalidInput for bytes that are neither or damaged, and for pictures of more than 128 million pixels.
Image decode_picture(std::string_view bytes, const std::string& name);

/// `drawn` over a picture of the same size, covering it by `opacity` in [0, 1] of its alpha. Throws
/// InvalidInput when the sizes differ.
Image overlay(const Image& picture, const Image& drawn, float opacity);

}  // namespace coppice
