#pragma once

#include <string>
#include <string_view>

namespace coppice {

/// The text, or its beginning and an ellipsis where it has more than `max_bytes` bytes, for a message. A
/// character of UTF-8 is not cut apart.
std::string shortened(std::string_view text, std::size_t max_bytes = 80);

/// The same in single quotes.
std::string quote(std::string_view text);

/// The text as one line: control characters, which names of files may hold, are written as escape sequences.
std::string printable(std::string_view text);

}  // namespace coppice
