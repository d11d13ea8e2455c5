#include "coppice/render/png.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <new>

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

void append(png_structp png, png_bytep bytes, std::size_t size) {
    try {
        static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(bytes), size);
    } catch (const std::bad_alloc&) {
        png_error(png, "out of memory");  // no exception may pass through the library
    }
}

// Without these functions the library prints messages.
void fail_silently(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void ignore_warning(png_structp, png_const_charp) {}

/// Numbers [m] of a map as the text of chunks: heights of pCAL, extents of a pixel of sCAL.
struct Calibration {
    std::string low, range, width, height;
};

/// Calibrates the values from 0 to the maximum.
void set_calibration(png_structp png, png_infop info, int bits, Calibration& calibration) {
    char purpose[] = "height", unit[] = "m";
    char* parameters[] = {calibration.low.data(), calibration.range.data()};
    png_set_pCAL(png, info, purpose, 0, (1 << bits) - 1, PNG_EQUATION_LINEAR, 2, unit, parameters);
}

/// Returns false if the library reports an error, from which it returns by a jump: no object with a
/// destructor is created here.
bool write_map(png_structp png, png_infop info, const PngMap& map, Calibration& calibration) {
    constexpr int kRunLengths = 3;  // Z_RLE: for maps of noise smaller and faster than the search for repeats
    if (setjmp(png_jmpbuf(png))) return false;
    png_set_compression_strategy(png, kRunLengths);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_PAETH);
    png_set_IHDR(png, info, static_cast<png_uint_32>(map.width), static_cast<png_uint_32>(map.height),
                 map.bits, map.channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (map.low != map.high) set_calibration(png, info, map.bits, calibration);
    if (map.tile_width > 0 && map.tile_height > 0)
        png_set_sCAL_s(png, info, PNG_SCALE_METER, calibration.width.data(), calibration.height.data());
    png_write_info(png, info);
    if (map.bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
    const std::size_t row = map.samples.size() / static_cast<std::size_t>(map.height);
    for (int j = 0; j < map.height; ++j)
        png_write_row(
            png, reinterpret_cast<png_const_bytep>(map.samples.data()) + static_cast<std::size_t>(j) * row);
    png_write_end(png, nullptr);
    return true;
}

void check(const PngMap& map) {
    const bool sound = map.width > 0 && map.height > 0 && (map.channels == 1 || map.channels == 3) &&
                       (map.bits == 8 || map.bits == 16);
    const std::size_t bytes = sound ? static_cast<std::size_t>(map.width) *
                                          static_cast<std::size_t>(map.height) *
                                          static_cast<std::size_t>(map.channels * map.bits / 8)
                                    : 0;
    if (!sound || map.samples.size() != bytes)
        throw InvalidInput(
            "a map needs pixels of one or three channels of 8 or 16 bits to be encoded as PNG");
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

std::string encode_png(const PngMap& map) {
    check(map);
    std::string out;
    out.reserve(map.samples.size() / 2);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail_silently, ignore_warning);
    png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
    Calibration calibration{fmt::format("{}", map.low), fmt::format("{}", map.high - map.low),
                            fmt::format("{}", double{map.tile_width} / map.width),
                            fmt::format("{}", double{map.tile_height} / map.height)};
    bool written = false;
    if (info != nullptr) {
        png_set_write_fn(png, &out, append, nullptr);
        written = write_map(png, info, map, calibration);
    }
    png_destroy_write_struct(&png, &info);
    if (!written) throw std::bad_alloc();
    return out;
}

bool is_png_name(const std::filesystem::path& path) {
    return path.extension() == ".png" || path.extension() == ".PNG";
}

}  // namespace coppice
