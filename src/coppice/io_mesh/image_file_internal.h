#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace coppice::io_internal {

/// Formats of images of materials.
enum class ImageFormat : std::uint8_t { png, jpeg };

/// Returns the format of an image from its contents. Throws InvalidInput, naming the file, if it is neither
/// PNG nor JPEG, if it is truncated, or if a side has no pixels or more than 32,768, which no graphics card
/// draws.
ImageFormat check_image(std::string_view bytes, const std::filesystem::path& path);

/// Returns the contents of a file with an image, of 256 MiB at most, for check_image(). Throws IoError if it
/// cannot be read or is larger.
std::string read_image(const std::filesystem::path& path);

}  // namespace coppice::io_internal
