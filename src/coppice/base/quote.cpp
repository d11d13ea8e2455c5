#include "coppice/base/quote.h"

#include <fmt/format.h>

namespace coppice {

std::string shortened(std::string_view text, std::size_t max_bytes) {
    if (text.size() <= max_bytes) return std::string(text);
    const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; };
    std::size_t end = max_bytes;
    while (end > 0 && continues(text[end])) --end;
    return std::string(text.substr(0, end)) + "...";
}

std::string quote(std::string_view text) { return fmt::format("'{}'", shortened(text)); }

std::string printable(std::string_view text) {
    std::string out;
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '\n') {
            out += "\\n";
        } else if (c == '\t') {
            out += "\\t";
        } else if (code < 0x20 || code == 0x7f) {
            out += fmt::format("\\x{:02x}", code);
        } else {
            out += c;
        }
    }
    return out;
}

}  // namespace coppice
