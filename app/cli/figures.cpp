#include "figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace coppice::cli {
namespace {

std::string text_of_number(double number) {
    // Map coordinates need more digits before the decimal point than six significant digits provide.
    const double size = std::abs(number);
    return size >= 1e5 && size < 1e9 ? fmt::format("{:.2f}", number) : fmt::format("{:.6g}", number);
}

/// Formats a value within a line.
std::string to_text(const Json& value, std::string_view unknown) {
    if (value.is_null()) return std::string(unknown);
    if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number_float()) return text_of_number(value.get<double>());
    if (value.is_number()) {
        const bool negative = !value.is_number_unsigned() && value.get<std::int64_t>() < 0;
        return (negative ? "-" : "") +
               grouped(negative ? -value.get<std::uint64_t>() : value.get<std::uint64_t>());
    }
    std::string text;
    for (const auto& [name, part] : value.items()) {
        text += fmt::format("{}{}{}", text.empty() ? "" : "  ", value.is_object() ? name + " " : "",
                            to_text(part, unknown));
    }
    return text;
}

}  // namespace

std::string figures_json(const Json& figures) {
    return figures.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string figures_text(const Json& figures, std::string_view unknown) {
    std::size_t width = 0;
    for (const auto& [name, figure] : figures.items()) width = std::max(width, name.size());
    std::string text;
    for (const auto& [name, figure] : figures.items())
        text += fmt::format("{:<{}}  {}\n", name, width, to_text(figure, unknown));
    return text;
}

}  // namespace coppice::cli
