#include "coppice/io/skeleton/node_attribute.h"

#include <algorithm>
#include <array>

namespace coppice {

bool is_attribute_name(std::string_view name) {
    static constexpr std::array<std::string_view, 11> kTaken{
        "x", "y", "z", "r", "radius", "parent", "position", "stable_id", "origin", "version", "format"};
    const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
    const auto fits = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; };
    return !name.empty() && is_letter(name.front()) && std::ranges::all_of(name, fits) &&
           std::ranges::find(kTaken, name) == kTaken.end();
}

}  // namespace coppice
