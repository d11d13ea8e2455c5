#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

#include "coppice/base/fields.h"

namespace coppice {

/// What a file may hold.
enum class FileKind {
    skeleton,  ///< nodes with radii, or cylinders
    mesh,      ///< faces
    points     ///< neither edges nor faces
};

template <>
struct EnumNames<FileKind> {
    static constexpr std::array<std::string_view, 3> names{"skeleton", "mesh", "points"};
};

/// What a file holds, by its name, and by its content where several kinds share an ending (OBJ, PLY, OFF,
/// TXT, CSV) or the ending is unknown; none when both are unknown. What is no plain file, such as a pipe, is
/// only judged by its name. Throws `IoError` when a file is missing or cannot be read, and `Unsupported` for
/// the formats that unread_format() knows.
std::optional<FileKind> kind_of_file(const std::filesystem::path& path);

/// What a file of this name is to hold; a name that fits several kinds (OBJ, PLY) is of the kind `preferred`.
/// None when its ending is unknown.
std::optional<FileKind> kind_of_output(const std::filesystem::path& path, FileKind preferred);

}  // namespace coppice
