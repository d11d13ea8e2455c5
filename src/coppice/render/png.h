#pragma once

#include <filesystem>
#include <string>

#include "coppice/render/image.h"

namespace coppice {

/// The bytes of a PNG file with the picture: RGB where every pixel is opaque, otherwise RGBA. The same image
/// gives the same bytes. Throws InvalidInput for a picture without pixels. The caller writes the bytes;
/// nothing is written here.
std::string encode_png(const Image& image);

/// Whether the name ends in .png or .PNG.
bool is_png_name(const std::filesystem::path& path);

}  // namespace coppice
