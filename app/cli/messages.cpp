#include "messages.h"

#include <algorithm>

#include "coppice/base/quote.h"
#include "streams.h"

namespace coppice::cli {

namespace {

/// Returns a word of at most 255 bytes, the maximum length of a file name; removes the middle of a longer
/// one.
std::string short_word(std::string_view word) {
    constexpr std::size_t kMaxWord = 255, kEnd = 52;
    if (word.size() <= kMaxWord) return std::string(word);
    std::string_view end = word.substr(word.size() - kEnd);
    while (!end.empty() && (static_cast<unsigned char>(end.front()) & 0xc0) == 0x80) end.remove_prefix(1);
    return shortened(word, kMaxWord - kEnd - 3) + std::string(end);
}

}  // namespace

std::string one_line(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t word = std::min(text.find(' '), text.size());
        const std::size_t end = std::min(text.find_first_not_of(' ', word), text.size());
        out += printable(short_word(text.substr(0, word)));
        out += text.substr(word, end - word);
        text.remove_prefix(end);
    }
    return out;
}

void say(std::string_view message) { print_error("coppice: " + one_line(message) + "\n"); }

}  // namespace coppice::cli
