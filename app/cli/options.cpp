#include "options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

namespace coppice::cli::detail {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Bounds of angles are rounded radians, so their degrees have stray digits.
std::string number_text(const Field& field, double value) {
    return field.unit == Unit::radian ? fmt::format("{:.4g}", value / kDegree) : fmt::format("{:.6g}", value);
}

std::string range_text(const Field& field) {
    return fmt::format("{} to {}", number_text(field, field.low), number_text(field, field.high));
}

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

}  // namespace

std::string flag_name(std::string_view field_name) {
    std::string flag = "--" + std::string(field_name);
    std::ranges::replace(flag, '_', '-');
    return flag;
}

double shown(const Field& field, double value) {
    return field.unit == Unit::radian ? value / kDegree : value;
}

double parse_number(const std::string& text, const std::string& flag, const Field& field, bool whole) {
    double number = 0;
    const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), number);
    const bool parsed = error == std::errc() && end == text.data() + text.size() && std::isfinite(number);
    const double limit = whole ? std::numeric_limits<int>::max() : std::numeric_limits<float>::max();
    const bool ranged = field.low < field.high;
    const double low = ranged ? shown(field, field.low) : -limit,
                 high = ranged ? shown(field, field.high) : limit;
    if (parsed && (!whole || number == std::floor(number)) && number >= low && number <= high) {
        const double value = field.unit == Unit::radian ? number * kDegree : number;
        return ranged ? std::clamp(value, field.low, field.high) : value;
    }
    const std::string unit(unit_text(field.unit));
    throw UsageError(fmt::format("{} takes a {}{}{}{}, not '{}'", flag, whole ? "whole number" : "number",
                                 unit.empty() ? "" : " of " + unit, ranged ? " from " : "",
                                 ranged ? range_text(field) : "", text));
}

std::size_t parse_name(const std::string& text, const std::string& flag,
                       std::span<const std::string_view> names) {
    const auto found = std::ranges::find(names, text);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    const std::vector<std::string> known(names.begin(), names.end());
    throw UsageError(fmt::format("{} takes one of {}, not '{}'{}", flag, fmt::join(names, ", "), text,
                                 did_you_mean(text, known)));
}

std::string number_help(const Field& field, double default_value) {
    std::string text = "[";
    if (field.unit != Unit::none) text += fmt::format("{}; ", unit_text(field.unit));
    if (field.low < field.high) text += range_text(field) + "; ";
    return text + fmt::format("default {}]", number_text(field, default_value));
}

}  // namespace coppice::cli::detail
