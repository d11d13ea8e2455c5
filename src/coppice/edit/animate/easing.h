#pragma once

#include <array>
#include <string_view>

#include "coppice/base/fields.h"

namespace coppice {

/// Speed profile of a motion between two keys.
enum class Easing {
    smooth,  ///< starts and ends at rest
    linear,  ///< constant speed
    in,      ///< starts at rest
    out,     ///< ends at rest
    hold,    ///< does not move until the end, then jumps
};

template <>
struct EnumNames<Easing> {
    static constexpr std::array<std::string_view, 5> names{"smooth", "linear", "in", "out", "hold"};
};

/// Returns the completed fraction of a motion at time t in [0, 1]: 0 at 0, 1 at 1, monotonic.
constexpr double eased(Easing easing, double t) {
    switch (easing) {
        case Easing::linear:
            return t;
        case Easing::in:
            return t * t;
        case Easing::out:
            return t * (2 - t);
        case Easing::hold:
            return t < 1 ? 0 : 1;
        case Easing::smooth:
            break;
    }
    return t * t * (3 - 2 * t);
}

}  // namespace coppice
