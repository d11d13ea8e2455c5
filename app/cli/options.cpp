#include "options.h"

#include <algorithm>
#include <cmath>

#include "coppice/pipeline/quantity.h"

namespace coppice::cli::detail {

std::string flag_name(std::string_view field_name) {
    std::string flag = "--" + std::string(field_name);
    std::ranges::replace(flag, '_', '-');
    return flag;
}

double parse_number(const std::string& text, const std::string& flag, const Field& field, bool whole) {
    const std::optional<double> number = parse_finite(text);
    const double limit = whole ? std::numeric_limits<int>::max() : std::numeric_limits<float>::max();
    const bool ranged = field.low < field.high;
    const double low = ranged ? in_typed_unit(field.unit, field.low) : -limit,
                 high = ranged ? in_typed_unit(field.unit, field.high) : limit;
    if (number && (!whole || *number == std::floor(*number)) && *number >= low && *number <= high) {
        const double value = in_library_unit(field.unit, *number);
        return ranged ? std::clamp(value, field.low, field.high) : value;
    }
    throw UsageError(fmt::format(
        "{} takes a {}, not '{}'", flag,
        quantity_text(whole ? "whole number" : "number", field.unit, field.low, field.high), text));
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
    if (field.low < field.high) text += range_text(field.unit, field.low, field.high) + "; ";
    return text + fmt::format("default {}]", number_text(field.unit, default_value));
}

}  // namespace coppice::cli::detail
