#pragma once

#include <cmath>

#include "coppice/base/vec.h"

namespace coppice::edit_internal {

/// A turn in space as a unit quaternion: averaging turns that are near each other is adding them.
struct Rotation {
    double w = 1;
    Vec3d v;

    Vec3d operator()(Vec3d p) const {
        const Vec3d t = cross(v, p) * 2.0;
        return p + t * w + cross(v, t);
    }
};

inline Rotation unit(Rotation r) {
    const double l = std::sqrt(r.w * r.w + length_squared(r.v));
    return l > 1e-30 ? Rotation{r.w / l, r.v / l} : Rotation{};
}

inline Rotation rotation_about(Vec3d unit_axis, double angle) {
    return {std::cos(angle / 2), unit_axis * std::sin(angle / 2)};
}

/// The shortest turn from one direction to another.
inline Rotation rotation_between(Vec3d from, Vec3d to) {
    const Vec3d a = normalized(from), b = normalized(to);
    const double c = dot(a, b);
    if (c < -1 + 1e-12) return {0, perpendicular(a)};
    return unit({1 + c, cross(a, b)});
}

/// The turn half-way between two.
inline Rotation between(Rotation a, Rotation b) {
    const double sign = a.w * b.w + dot(a.v, b.v) < 0 ? -1 : 1;
    return unit({a.w + sign * b.w, a.v + b.v * sign});
}

}  // namespace coppice::edit_internal
