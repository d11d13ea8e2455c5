#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "coppice/render/image.h"

namespace coppice {

/// Returns the bytes of a PNG file of the image: RGB if every pixel is opaque, otherwise RGBA. Equal images
/// give equal bytes. Throws InvalidInput for an image without pixels. The caller writes the bytes; this
/// function writes no files.
std::string encode_png(const Image& image);

/// Samples of a map: rows from the top, channels of a pixel together, 16 bits in the order of the machine.
struct PngMap {
    int width = 0;                       ///< [pixels]
    int height = 0;                      ///< [pixels]
    int channels = 1;                    ///< 1: grey, 3: red, green and blue
    int bits = 8;                        ///< per channel: 8 or 16
    std::span<const std::byte> samples;  ///< width * height * channels * bits / 8 bytes
    float low = 0;                       ///< [m] height of the value 0
    float high = 0;                      ///< [m] height of the maximum value; equal to `low` if not heights
    float tile_width = 0;                ///< [m] extent of the image on the surface; 0 if unknown
    float tile_height = 0;               ///< [m] extent of the image on the surface; 0 if unknown
};

/// Returns the bytes of a PNG file of a map, without a colour space; compressed for speed, as maps of noise
/// hardly compress. The range of heights is stored in a pCAL chunk, the extent in an sCAL chunk. Equal maps
/// give equal bytes. Cost: about 20 ns of CPU time per byte of samples. Throws InvalidInput if the map has no
/// pixels, or another number of channels, bits or bytes.
std::string encode_png(const PngMap& map);

/// Returns whether the name ends in .png or .PNG.
bool is_png_name(const std::filesystem::path& path);

}  // namespace coppice
