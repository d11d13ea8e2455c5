#include "coppice/options/quantity.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>

namespace coppice {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

double in_library_unit(Unit unit, double typed) { return unit == Unit::radian ? typed * kDegree : typed; }

double in_typed_unit(Unit unit, double value) { return unit == Unit::radian ? value / kDegree : value; }

std::string_view unit_text(Unit unit) {
    switch (unit) {
        case Unit::metre:
            return "metres";
        case Unit::radian:
            return "degrees";
        case Unit::radius:
            return "radii";
        case Unit::second:
            return "seconds";
        case Unit::none:
            break;
    }
    return "";
}

std::string number_text(Unit unit, double value) {
    const double typed = in_typed_unit(unit, value);
    const std::string text = fmt::format("{:.{}g}", typed, unit == Unit::radian ? 4 : 6);
    // All digits of a whole number are shown.
    const bool is_rounded = unit == Unit::none && typed == std::floor(typed) && parse_finite(text) != typed;
    return is_rounded ? fmt::format("{:.0f}", typed) : text;
}

std::string range_text(Unit unit, double low, double high) {
    return fmt::format("{} to {}", number_text(unit, low), number_text(unit, high));
}

std::string quantity_text(std::string_view noun, Unit unit, double low, double high) {
    std::string text(noun);
    if (unit != Unit::none) text += fmt::format(" of {}", unit_text(unit));
    if (low < high) text += fmt::format(" from {}", range_text(unit, low, high));
    return text;
}

std::string grouped(std::uint64_t number) {
    constexpr std::size_t kGroup = 3;
    std::string text = fmt::format("{}", number);
    for (std::size_t at = text.size(); at > kGroup;) {
        at -= kGroup;
        text.insert(at, 1, ',');
    }
    return text;
}

std::optional<double> parse_finite(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(number)) return {};
    return number;
}

}  // namespace coppice
