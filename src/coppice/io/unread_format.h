#pragma once

#include <optional>
#include <string_view>

namespace coppice {

/// Returns the format of a known but unsupported file and how to convert it: "an HDF5 file, which is not
/// read; save ..."; nullopt for all other files. The first bytes of the file suffice.
std::optional<std::string_view> unread_format(std::string_view bytes);

}  // namespace coppice
