#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "coppice/mesh/height_texture.h"

namespace coppice {

/// Returns the heights of a grey PNG of 16 bits, with the scale of its pCAL chunk if that is in metres, as
/// encode_png() writes it. `name` is that of the file, for messages. Throws InvalidInput for other files,
/// damaged ones, and images of more than 2^26 pixels.
HeightTexture decode_height_png(std::string_view bytes, const std::string& name);

/// Extent of an image on a surface.
struct TileSize {
    float width = 0;   ///< [m]
    float height = 0;  ///< [m]
};

/// Returns the extent of the subject of a PNG file, by its sCAL chunk in metres; nullopt if the file has none
/// with extents between 1 mm and 1 km, or is not a PNG file.
std::optional<TileSize> read_tile_size(std::string_view bytes);

}  // namespace coppice
