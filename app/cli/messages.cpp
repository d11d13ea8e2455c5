#include "messages.h"

#include <fmt/format.h>

#include "streams.h"

namespace coppice::cli {

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

void say(std::string_view message) { print_error(fmt::format("coppice: {}\n", printable(message))); }

}  // namespace coppice::cli
