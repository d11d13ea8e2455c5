#pragma once

#include <span>
#include <string>
#include <string_view>

namespace coppice {

/// The candidate that was most likely meant by a mistyped word, or nothing where none is near: letters left
/// out, added, changed or swapped, at most one for every three; else the shortest that begins with the word,
/// of at least three letters. Upper and lower case, dashes and underscores count as the same.
std::string nearest_spelling(std::string_view word, std::span<const std::string> candidates);

/// "; did you mean x?" or nothing: the end of a message about an unknown word.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

}  // namespace coppice
