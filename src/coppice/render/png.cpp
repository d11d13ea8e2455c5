#include "coppice/render/png.h"

#include <png.h>

#include <algorithm>

#include "coppice/base/error.h"

namespace coppice {
namespace {

std::string encode(png_image& header, const std::uint8_t* pixels) {
    std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(header), '\0');
    png_alloc_size_t size = bytes.size();
    if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, pixels, 0, nullptr)) {
        throw Unsupported(std::string("the image cannot be encoded as PNG: ") + header.message);
    }
    bytes.resize(size);
    return bytes;
}

}  // namespace

std::string encode_png(const Image& image) {
    if (image.width <= 0 || image.height <= 0)
        throw InvalidInput("an image without pixels cannot be encoded as PNG");
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(image.width);
    header.height = static_cast<png_uint_32>(image.height);
    const bool opaque = std::ranges::all_of(image.pixels, [](const auto& p) { return p[3] == 255; });
    if (!opaque) {
        header.format = PNG_FORMAT_RGBA;
        return encode(header, image.pixels.front().data());
    }
    header.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> rgb;
    rgb.reserve(3 * image.pixels.size());
    for (const auto& p : image.pixels) rgb.insert(rgb.end(), p.begin(), p.begin() + 3);
    return encode(header, rgb.data());
}

bool is_png_name(const std::filesystem::path& path) {
    return path.extension() == ".png" || path.extension() == ".PNG";
}

}  // namespace coppice
