#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// A command in a scene file: one line, or several joined by a backslash at the end of each except the last.
struct SceneLine {
    std::uint32_t number = 0;  ///< number of its first line in the file, from 1
    std::string text;          ///< without comments and line continuations
};

/// Returns the lines that contain more than blanks and comments. Throws InvalidInput naming `source` and the
/// line, for bytes that are not text, a line of more than kLongestLine bytes, more than kMaxLines lines, and
/// a backslash at the end of the text.
std::vector<SceneLine> scene_lines(std::string_view text, const std::string& source);

inline constexpr std::size_t kLongestLine = std::size_t{1} << 20;  ///< [bytes]
inline constexpr std::size_t kMaxLines = 100'000;                  ///< maximum number of lines of a file

/// A word of a line, or key=value.
struct SceneWord {
    std::string key;      ///< key of a word key=value, otherwise empty
    std::string text;     ///< text after the key, without quotes
    bool quoted = false;  ///< whether it was quoted
};

/// Splits a line into words at blanks. A `#` at the start of a word begins a comment. Double quotes preserve
/// blanks, also after `key=`; within them \" and \\ are escapes for " and \. ${...} preserves blanks too and
/// is kept unchanged. Throws InvalidInput for a quote that is not closed, and for more than 200,000 words.
std::vector<SceneWord> scene_words(std::string_view line);

/// Returns a word that is parsed to the same text: with quotes if required.
std::string quoted_word(std::string_view text);

}  // namespace coppice
