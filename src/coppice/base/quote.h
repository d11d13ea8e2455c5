#pragma once

#include <string>
#include <string_view>

namespace coppice {

/// Returns the text, or its beginning with an ellipsis if it has more than `max_bytes` bytes, for a message.
/// Does not cut a UTF-8 character.
std::string shortened(std::string_view text, std::size_t max_bytes = 80);

/// The same in single quotes.
std::string quote(std::string_view text);

/// Returns the text as one line: control characters, which file names may contain, are replaced by escape
/// sequences.
std::string printable(std::string_view text);

}  // namespace coppice
