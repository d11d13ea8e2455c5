#pragma once

#include <string>
#include <string_view>

namespace coppice::cli {

/// A text as one line: control characters, which names of files may hold, are written as \n, \t or \x1b.
std::string printable(std::string_view text);

/// One line on stderr that begins with "coppice: ".
void say(std::string_view message);

}  // namespace coppice::cli
