#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// A command as a scene file holds it: one line, or several joined by a backslash at the end of each but the
/// last.
struct SceneLine {
    std::uint32_t number = 0;  ///< of its first line in the file, from 1
    std::string text;          ///< without comments and joins
};

/// The lines that hold anything but blanks and comments. Throws InvalidInput naming `source` and the line:
/// bytes that are no text, a line of more than kLongestLine bytes, more than kMostLines lines, nothing after
/// a backslash.
std::vector<SceneLine> scene_lines(std::string_view text, const std::string& source);

inline constexpr std::size_t kLongestLine = std::size_t{1} << 20;  ///< [bytes]
inline constexpr std::size_t kMostLines = 100'000;                 ///< of one file

/// A word of a line, or key=value.
struct SceneWord {
    std::string key;      ///< of a word key=value, else empty
    std::string text;     ///< what stands after the key; without quotes
    bool quoted = false;  ///< whether quotes were there
};

/// Cuts a line into words at blanks. A `#` at the start of a word begins a comment. Double quotes keep blanks
/// together, also behind `key=`; within them \" and \\ stand for " and \. So does ${...}, which stays as it
/// is. Throws InvalidInput for a quote that is not closed, and for more than 200,000 words.
std::vector<SceneWord> scene_words(std::string_view line);

/// A word that is read back as it is: with quotes where it needs them.
std::string quoted_word(std::string_view text);

}  // namespace coppice
