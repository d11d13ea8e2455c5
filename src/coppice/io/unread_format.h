#pragma once

#include <optional>
#include <string_view>

namespace coppice {

/// Names the format of a file that begins with these bytes, and says how to convert it, where it is known but
/// not read: "an HDF5 file, which is not read; save ...". The beginning of the file is enough. None for
/// all other files.
std::optional<std::string_view> unread_format(std::string_view bytes);

}  // namespace coppice
