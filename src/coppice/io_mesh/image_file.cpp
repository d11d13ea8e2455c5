#include <fmt/format.h>

#include <optional>

#include "coppice/base/error.h"
#include "coppice/io_mesh/image_file_internal.h"
#include "coppice/system/file.h"

namespace coppice::io_internal {
namespace {

constexpr std::uint64_t kMaxImageBytes = std::uint64_t{256} << 20;
constexpr std::uint32_t kMaxSide = 32'768;  // [pixels]

struct ImageSize {
    std::uint32_t width = 0, height = 0;  // [pixels]
};

// Returns the big-endian number at an offset; 0 beyond the end.
std::uint32_t read_number(std::string_view bytes, std::size_t at, std::size_t size) {
    if (at + size > bytes.size()) return 0;
    std::uint32_t out = 0;
    for (const char c : bytes.substr(at, size)) out = out << 8 | static_cast<std::uint8_t>(c);
    return out;
}

std::optional<ImageSize> find_png_size(std::string_view bytes) {
    if (bytes.size() < 24 || bytes.substr(12, 4) != "IHDR") return std::nullopt;
    return ImageSize{read_number(bytes, 16, 4), read_number(bytes, 20, 4)};
}

// Returns the size in the first frame header.
std::optional<ImageSize> find_jpeg_size(std::string_view bytes) {
    constexpr std::size_t kFrame = 9;  // bytes of a segment up to the size of its image
    for (std::size_t at = 2; at + kFrame <= bytes.size();) {
        const std::uint32_t marker = read_number(bytes, at, 2), length = read_number(bytes, at + 2, 2);
        const bool is_table = marker == 0xffc4 || marker == 0xffc8 || marker == 0xffcc;
        if (marker >= 0xffc0 && marker <= 0xffcf && !is_table)
            return ImageSize{read_number(bytes, at + 7, 2), read_number(bytes, at + 5, 2)};
        if (marker < 0xff00 || length < 2) return std::nullopt;
        at += 2 + length;
    }
    return std::nullopt;
}

}  // namespace

ImageFormat check_image(std::string_view bytes, const std::filesystem::path& path) {
    const bool is_jpeg = bytes.starts_with("\xff\xd8");
    if (!is_jpeg && !bytes.starts_with("\x89PNG"))
        throw InvalidInput(path.string() + ": this is neither a PNG nor a JPEG image");
    const auto size = is_jpeg ? find_jpeg_size(bytes) : find_png_size(bytes);
    if (!size || bytes.rfind(is_jpeg ? "\xff\xd9" : "IEND") == std::string_view::npos)
        throw InvalidInput(path.string() + " ends before its image does; save the image again");
    if (size->width - 1 >= kMaxSide || size->height - 1 >= kMaxSide) {
        throw InvalidInput(fmt::format("{} has {} x {} pixels; scale it to sides of 1 to {} pixels",
                                       path.string(), size->width, size->height, kMaxSide));
    }
    return is_jpeg ? ImageFormat::jpeg : ImageFormat::png;
}

std::string read_image(const std::filesystem::path& path) { return read_file(path, kMaxImageBytes); }

}  // namespace coppice::io_internal
