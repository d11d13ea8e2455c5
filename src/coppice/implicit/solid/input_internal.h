#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "coppice/base/error.h"

namespace coppice {

/// [m] squares of it and sums of squares are valid also in single precision.
inline constexpr double kFarthest = 1e9;

/// Throws InvalidInput that names the value, unless |value| <= 1e9.
inline void check_coordinate(double value, std::string_view source, std::string_view subject, std::size_t i) {
    if (std::abs(value) <= kFarthest) return;
    throw InvalidInput(fmt::format("{}: {} {} must be within 1e9 m of the origin, but has a coordinate {}",
                                   source, subject, i + 1, value));
}

}  // namespace coppice
