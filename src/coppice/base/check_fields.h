#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <type_traits>

#include "coppice/base/error.h"
#include "coppice/base/option_struct.h"

namespace coppice {

/// Throws InvalidInput for the first field of `options`, or of a nested struct, that is out of its range,
/// NaN, or an undefined value of its enum. `source` names the owner of the options: "render: samples must be
/// between 1 and 4096, but is 0", "mesh: project.damping must ...".
template <OptionStruct Options>
void check_fields(const Options& options, std::string_view source, const std::string& path = {}) {
    visit_fields(options, [&](const Field& field, const auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        if constexpr (OptionStruct<T>) {
            check_fields(value, source, fmt::format("{}{}.", path, field.name));
        } else if constexpr (NamedEnum<T>) {
            const auto& names = EnumNames<T>::names;
            if (static_cast<std::size_t>(value) < names.size()) return;
            throw InvalidInput(
                fmt::format("{}: {}{} must be one of {}", source, path, field.name, fmt::join(names, ", ")));
        } else if constexpr (std::is_same_v<T, int> || std::is_same_v<T, float>) {
            if (field.low >= field.high) return;
            if (value >= static_cast<T>(field.low) && value <= static_cast<T>(field.high)) return;
            throw InvalidInput(fmt::format("{}: {}{} must be between {} and {}, but is {}", source, path,
                                           field.name, static_cast<T>(field.low), static_cast<T>(field.high),
                                           value));
        }
    });
}

}  // namespace coppice
