#pragma once

#include <fmt/format.h>

#include <string_view>
#include <type_traits>

#include "coppice/base/error.h"
#include "coppice/base/fields.h"

namespace coppice {

/// Throws InvalidInput naming the first field of `options` whose value is out of its range or not a number.
/// `source` says whose options these are: "render: samples must lie between 1 and 4096, but is 0".
template <class Options>
void check_fields(const Options& options, std::string_view source) {
    visit_fields(options, [&](const Field& field, const auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_same_v<T, int> || std::is_same_v<T, float>) {
            if (field.low >= field.high) return;
            if (value >= static_cast<T>(field.low) && value <= static_cast<T>(field.high)) return;
            throw InvalidInput(fmt::format("{}: {} must lie between {} and {}, but is {}", source, field.name,
                                           static_cast<T>(field.low), static_cast<T>(field.high), value));
        }
    });
}

}  // namespace coppice
