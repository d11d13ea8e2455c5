#pragma once

#include <string>
#include <string_view>

namespace coppice {

/// ASCII letters and digits, independent of the locale; other bytes are neither, and remain unchanged.
/// Returns whether the character is one of 0 to 9.
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
/// Returns whether the character is one of a to z or A to Z.
constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
/// Converts a capital letter to a small one; returns other characters unchanged.
constexpr char to_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
/// Converts all capital letters of a text.
inline std::string to_lower(std::string_view text) {
    std::string lower(text);
    for (char& c : lower) c = to_lower(c);
    return lower;
}

}  // namespace coppice
