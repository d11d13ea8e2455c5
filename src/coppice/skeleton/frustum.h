#pragma once

#include <cmath>
#include <numbers>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The cone between the ends of a segment, without the balls there.
struct Frustum {
    double radius_a = 0;  ///< [m] at the parent
    double radius_b = 0;  ///< [m] at the node
    double length = 0;    ///< [m]

    /// [m^3]
    double volume() const {
        const double a = radius_a, b = radius_b;
        return std::numbers::pi / 3 * length * (a * a + a * b + b * b);
    }
    /// [m^2] without the discs at the ends
    double mantle() const {
        return std::numbers::pi * (radius_a + radius_b) * std::hypot(radius_a - radius_b, length);
    }
};

/// That of a segment, with the radii it has at its ends.
inline Frustum frustum(const Segment& s) {
    return {s.radius_a, s.radius_b, distance(Vec3d(s.a), Vec3d(s.b))};
}

}  // namespace coppice
