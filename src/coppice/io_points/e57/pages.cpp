#include "coppice/io_points/e57/pages_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "coppice/base/error.h"

namespace coppice::e57 {
namespace {

constexpr std::array<std::uint32_t, 256> make_table() {
    constexpr std::uint32_t kPolynomial = 0x82f63b78;  // CRC-32C, least significant bit first
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < table.size(); ++i) {
        std::uint32_t c = i;
        for (int bit = 0; bit < 8; ++bit) c = (c & 1u) != 0 ? c >> 1 ^ kPolynomial : c >> 1;
        table[i] = c;
    }
    return table;
}

std::uint32_t crc32c(std::string_view bytes) {
    static constexpr std::array<std::uint32_t, 256> kTable = make_table();
    std::uint32_t crc = ~0u;
    for (const char c : bytes) crc = crc >> 8 ^ kTable[(crc ^ static_cast<std::uint8_t>(c)) & 255u];
    return ~crc;
}

std::uint32_t big_endian(std::string_view bytes) {
    std::uint32_t value = 0;
    for (const char c : bytes) value = value << 8 | static_cast<std::uint8_t>(c);
    return value;
}

}  // namespace

Pages::Pages(std::string_view file, const std::string& source)
    : file_(file), source_(source), pages_(file.size() / kPage), checked_(pages_, false) {}

std::uint64_t Pages::logical(std::uint64_t physical) const {
    if (physical % kPage >= kContent || physical / kPage >= pages_) {
        throw InvalidInput(fmt::format(
            "{}: the E57 file is cut off or damaged: a section should begin at byte {}", source_, physical));
    }
    return physical / kPage * kContent + physical % kPage;
}

std::string Pages::read(std::uint64_t at, std::uint64_t size) {
    if (at > this->size() || size > this->size() - at) {
        throw InvalidInput(fmt::format(
            "{}: the E57 file is cut off or damaged: it ends before a section that it names", source_));
    }
    std::string out;
    out.reserve(size);
    while (out.size() < size) {
        const std::uint64_t from = at + out.size();
        out += content(from / kContent).substr(from % kContent, size - out.size());
    }
    return out;
}

std::string_view Pages::content(std::uint64_t page) {
    const std::string_view bytes = file_.substr(page * kPage, kPage);
    const std::string_view content = bytes.substr(0, kContent);
    if (!checked_[page] && crc32c(content) != big_endian(bytes.substr(kContent))) {
        throw InvalidInput(
            fmt::format("{}: page {} of {} of the E57 file is damaged: its checksum does not match", source_,
                        page + 1, pages_));
    }
    checked_[page] = true;
    return content;
}

}  // namespace coppice::e57
