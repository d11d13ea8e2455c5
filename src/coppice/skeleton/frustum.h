#pragma once

#include <cmath>
#include <numbers>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Truncated cone between the ends of a segment, without the balls at the ends.
struct Frustum {
    double radius_a = 0;  ///< [m] at the parent
    double radius_b = 0;  ///< [m] at the node
    double length = 0;    ///< [m]

    /// Returns the volume in cubic metres.
    double volume() const {
        const double a = radius_a, b = radius_b;
        return std::numbers::pi / 3 * length * (a * a + a * b + b * b);
    }
    /// Returns the lateral area in square metres, without the end discs.
    double mantle() const {
        return std::numbers::pi * (radius_a + radius_b) * std::hypot(radius_a - radius_b, length);
    }
};

/// Returns the frustum of a segment, with the radii at its ends.
inline Frustum frustum(const Segment& s) {
    return {s.radius_a, s.radius_b, distance(Vec3d(s.a), Vec3d(s.b))};
}

}  // namespace coppice
