#include "coppice/pipeline/json.h"

#include <algorithm>
#include <cmath>

namespace coppice {

std::string_view name_of_unit(Unit unit) {
    static constexpr std::array<std::string_view, 5> kNames{"none", "metre", "radian", "radius", "second"};
    return kNames[static_cast<std::size_t>(unit)];
}

double shortest(float value) {
    if (!std::isfinite(value)) return value;
    return std::stod(fmt::format("{}", value));
}

namespace pipeline_internal {

void check_keys(const Json& object, const std::vector<std::string>& known, const std::string& where) {
    if (!object.is_object()) throw InvalidInput(where + " must be an object with named fields");
    for (const auto& [key, value] : object.items()) {
        if (std::ranges::find(known, key) != known.end()) continue;
        throw InvalidInput(fmt::format("{}: there is no field {}{}", where, key, did_you_mean(key, known)));
    }
}

bool read_bool(const Json& value, const std::string& where) {
    if (!value.is_boolean()) throw InvalidInput(where + " must be true or false");
    return value.get<bool>();
}

double read_number(const Json& value, const Field& field, bool whole, const std::string& where) {
    const bool right_kind = whole ? value.is_number_integer() : value.is_number();
    if (!right_kind)
        throw InvalidInput(fmt::format("{} must be a {}", where, whole ? "whole number" : "number"));
    const double number = value.get<double>();
    const double limit = whole ? std::numeric_limits<int>::max() : std::numeric_limits<float>::max();
    const bool ranged = field.low < field.high;
    const double low = ranged ? field.low : -limit, high = ranged ? field.high : limit;
    if (number >= low && number <= high) return number;
    throw InvalidInput(fmt::format("{} must lie between {} and {}, but is {}", where, low, high, number));
}

std::size_t read_name(const Json& value, std::span<const std::string_view> names, const std::string& where) {
    if (value.is_string()) {
        const auto found = std::ranges::find(names, value.get_ref<const std::string&>());
        if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    }
    throw InvalidInput(fmt::format("{} must be one of {}", where, fmt::join(names, ", ")));
}

}  // namespace pipeline_internal
}  // namespace coppice
