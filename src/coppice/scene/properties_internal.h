#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// An option in a file of options.
struct Property {
    std::uint32_t line = 0;  ///< line of the file, from 1
    std::string name;        ///< name of the option
    std::string value;       ///< as entered, without quotes
};

/// Parses a file of options: a name and a value separated by "=", ":" or blanks on each line; `#` begins a
/// comment. Throws InvalidInput, naming `source` and the line, if a name has no value.
std::vector<Property> parse_properties(std::string_view text, const std::string& source);

}  // namespace coppice
