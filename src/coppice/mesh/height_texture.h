#pragma once

#include <cstdint>
#include <vector>

namespace coppice {

/// Heights of a texture that repeats: u is to the right in it, v up.
struct HeightTexture {
    int width = 0;                       ///< [pixels]
    int height = 0;                      ///< [pixels]
    float scale = 0;                     ///< [m] difference in height of 0 and 65535; 0 if unknown
    std::vector<std::uint16_t> heights;  ///< width * height, in rows from the top
};

}  // namespace coppice
