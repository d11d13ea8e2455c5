#pragma once

#include <string>
#include <string_view>

namespace coppice {

/// Returns a PNG file with a size but without pixels.
inline std::string small_image() {
    constexpr std::string_view kBytes(
        "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x10\0\0\0\x10\x08\x02\0\0\0\0\0\0\0\0\0\0\0IEND", 41);
    return std::string(kBytes);
}

}  // namespace coppice
