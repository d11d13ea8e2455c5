#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/texture/bark.h"

namespace coppice {

/// A map of bark as the bytes of an image.
struct BarkImage {
    std::string_view map;  ///< "color"; its file is PREFIX_color.png
    std::string bytes;     ///< PNG
};

/// Encodes one map: color, normal, height, orm, roughness or occlusion. Equal maps give equal bytes.
std::string encode_bark_map(const BarkMaps& maps, std::string_view map);
/// Encodes all maps: color, normal, height, orm, roughness and occlusion.
std::vector<BarkImage> encode_bark(const BarkMaps& maps, const Context& ctx = {});

/// Returns the name of the file of a map.
std::string make_bark_file_name(const std::string& prefix, std::string_view map);

}  // namespace coppice
