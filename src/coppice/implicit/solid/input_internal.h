#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "coppice/base/error.h"

namespace coppice {

inline constexpr double kFarthest =
    1e9;  ///< [m] squares of it and sums of them are safe also in single precision

/// Throws InvalidInput, naming what it is, unless |value| <= 1e9.
inline void check_coordinate(double value, std::string_view source, std::string_view what, std::size_t i) {
    if (std::abs(value) <= kFarthest) return;
    throw InvalidInput(fmt::format("{}: {} {} must lie within 1e9 m of the origin, but has a coordinate {}",
                                   source, what, i + 1, value));
}

}  // namespace coppice
