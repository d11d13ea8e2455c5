#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

#include "coppice/base/fields.h"

namespace coppice {

/// Kind of content of a file.
enum class FileKind {
    skeleton,  ///< nodes with radii, or cylinders
    mesh,      ///< faces
    points     ///< neither edges nor faces
};

template <>
struct EnumNames<FileKind> {
    static constexpr std::array<std::string_view, 3> names{"skeleton", "mesh", "points"};
};

/// Returns the kind of a file by its extension, and by its content if several kinds share the extension (OBJ,
/// PLY, OFF, TXT, CSV) or the extension is unknown; returns nullopt if both are unknown. Only the extension
/// is considered if the path is not a regular file, such as a pipe. Throws `IoError` if the file is missing
/// or cannot be read, and `Unsupported` for the formats recognized by unread_format().
std::optional<FileKind> kind_of_file(const std::filesystem::path& path);

/// Returns the kind of an output file by its extension; `preferred` if several kinds share the extension
/// (OBJ, PLY), nullopt if it is unknown.
std::optional<FileKind> kind_of_output(const std::filesystem::path& path, FileKind preferred);

}  // namespace coppice
