#pragma once

#include <span>
#include <string>
#include <string_view>

namespace coppice {

/// Returns the candidate that a mistyped word most probably means, or nullopt if none is close: letters left
/// out, added, changed or swapped, at most one for every three; otherwise the shortest candidate that begins
/// with the word, of at least three letters. Upper and lower case, and dashes and underscores, count as
/// equal.
std::string nearest_spelling(std::string_view word, std::span<const std::string> candidates);

/// Returns "; did you mean x?" or an empty string: the end of a message about an unknown word.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

}  // namespace coppice
