// Decodes PNG and JPEG images, heights, and the extents of tiles from arbitrary bytes: all pixels are there,
// or coppice::InvalidInput is thrown.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "coppice/base/error.h"
#include "coppice/render/picture.h"
#include "coppice/render/png_reader.h"

namespace {

constexpr unsigned kMaxSide = 1024;  // larger images only need time with sanitizers

unsigned two_bytes(std::string_view bytes, std::size_t at) {
    return static_cast<unsigned char>(bytes[at]) * 256u + static_cast<unsigned char>(bytes[at + 1]);
}

bool is_large_png(std::string_view bytes) {
    constexpr std::size_t kWidth = 16, kEnd = 24;  // two numbers of four bytes
    if (bytes.size() < kEnd) return false;
    return two_bytes(bytes, kWidth) > 0 || two_bytes(bytes, kWidth + 2) > kMaxSide ||
           two_bytes(bytes, kWidth + 4) > 0 || two_bytes(bytes, kWidth + 6) > kMaxSide;
}

// Looks at every place that may begin a frame.
bool is_large_jpeg(std::string_view bytes) {
    for (std::size_t i = 0; i + 9 <= bytes.size(); ++i) {
        const auto marker = static_cast<unsigned char>(bytes[i + 1]);
        if (bytes[i] != '\xff' || marker < 0xc0 || marker > 0xcf) continue;
        if (two_bytes(bytes, i + 5) > kMaxSide || two_bytes(bytes, i + 7) > kMaxSide) return true;
    }
    return false;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    if (bytes.starts_with("\x89PNG") ? is_large_png(bytes) : is_large_jpeg(bytes)) return 0;
    try {
        const coppice::Image image = coppice::decode_picture(bytes, "input");
        const auto count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
        if (count == 0 || image.pixels.size() != count) std::abort();
    } catch (const coppice::InvalidInput&) {  // expected for an invalid file
    }
    try {
        const coppice::HeightTexture texture = coppice::decode_height_png(bytes, "input");
        const auto count = static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height);
        if (count == 0 || texture.heights.size() != count || !(texture.scale >= 0)) std::abort();
    } catch (const coppice::InvalidInput&) {  // expected for other images
    }
    const auto tile = coppice::read_tile_size(bytes);
    if (tile && !(tile->width > 0 && tile->height > 0)) std::abort();
    return 0;
}
