#pragma once

#include <string>
#include <string_view>

namespace coppice::cli {

/// Returns the text as one line: control characters are escaped, and words of more than 255 bytes, such as a
/// path, lose their middle.
std::string one_line(std::string_view text);

/// Prints one line on stderr that begins with "coppice: ".
void say(std::string_view message);

}  // namespace coppice::cli
