#include "figures.h"

#include <fmt/format.h>

#include <algorithm>

#include "files.h"

namespace coppice::cli {
namespace {

std::string value_text(const Json& value) {
    if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number_unsigned()) return grouped(value.get<std::uint64_t>());
    if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
    return value.dump();
}

std::string line_text(const Json& value) {
    if (!value.is_structured()) return value_text(value);
    std::string text;
    for (const auto& [name, member] : value.items()) {
        if (!text.empty()) text += "  ";
        text += value.is_array() ? value_text(member) : name + " " + value_text(member);
    }
    return text;
}

}  // namespace

std::string figures_text(const Json& figures) {
    std::size_t width = 0;
    for (const auto& [name, value] : figures.items()) width = std::max(width, name.size());
    std::string text;
    for (const auto& [name, value] : figures.items())
        text += fmt::format("{:<{}}  {}\n", name, width, line_text(value));
    return text;
}

}  // namespace coppice::cli
