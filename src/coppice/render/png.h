#pragma once

#include <filesystem>
#include <string>

#include "coppice/render/image.h"

namespace coppice {

/// Returns the bytes of a PNG file of the image: RGB if every pixel is opaque, otherwise RGBA. Equal images
/// give equal bytes. Throws InvalidInput for an image without pixels. The caller writes the bytes; this
/// function writes no files.
std::string encode_png(const Image& image);

/// Returns whether the name ends in .png or .PNG.
bool is_png_name(const std::filesystem::path& path);

}  // namespace coppice
