#pragma once

#include <string>
#include <string_view>

namespace coppice {

/// Letters and digits of ASCII, the same in any locale; other bytes are neither, and stay as they are.
/// Whether it is one of 0 to 9.
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
/// Whether it is one of a to z or A to Z.
constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
/// The small letter of a capital one; all else as it is.
constexpr char to_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
/// The same of every letter.
inline std::string to_lower(std::string_view text) {
    std::string lower(text);
    for (char& c : lower) c = to_lower(c);
    return lower;
}

}  // namespace coppice
