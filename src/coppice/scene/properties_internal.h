#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// An option in a file of properties.
struct Property {
    std::uint32_t line = 0;  ///< of the file, from 1
    std::string name;        ///< of the option
    std::string value;       ///< as it would be typed, without quotes
};

/// The lines of a file of properties: a name and a value with "=", ":" or blanks between them; `#` begins a
/// comment. Throws InvalidInput, naming `source` and the line, where a name has no value.
std::vector<Property> properties_of(std::string_view text, const std::string& source);

}  // namespace coppice
