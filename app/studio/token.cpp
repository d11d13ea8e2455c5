#include "token.h"

#include <sys/random.h>

#include <array>

#include "coppice/base/error.h"

namespace coppice::server {

std::string make_token() {
    constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    std::array<unsigned char, 32> bytes{};
    if (getentropy(bytes.data(), bytes.size()) != 0)
        throw IoError("the system provides no random numbers for the token of the studio");
    std::string out;
    unsigned bits = 0;
    int count = 0;
    for (const unsigned char byte : bytes) {
        bits = bits << 8 | byte;
        for (count += 8; count >= 6; count -= 6) out += kLetters[bits >> (count - 6) & 63];
    }
    out += kLetters[bits << (6 - count) & 63];
    return out;
}

bool same_token(std::string_view given, std::string_view token) {
    unsigned different = given.size() == token.size() ? 0 : 1;
    for (std::size_t i = 0; i < token.size(); ++i) {
        const char c = i < given.size() ? given[i] : '\0';
        different |= static_cast<unsigned char>(c) ^ static_cast<unsigned char>(token[i]);
    }
    return different == 0;
}

}  // namespace coppice::server
