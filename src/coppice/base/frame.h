#pragma once

#include "coppice/base/vec.h"

namespace coppice {

/// Returns v rotated by the smallest rotation that maps the unit vector `from` to `to`; v is perpendicular to
/// `from`.
inline Vec3d turned(Vec3d v, Vec3d from, Vec3d to) {
    const double c = 1 + dot(from, to);
    return c > 1e-12 ? v - (from + to) * (dot(v, to) / c) : v;
}

/// Transports the normal of a frame at `from` to `to` with minimal rotation about the unit tangents:
/// reflected onto the new position, then onto the new tangent [Wang2008]. The error is of fourth order in the
/// step.
inline Vec3d carried(Vec3d normal, Vec3d from, Vec3d tangent_from, Vec3d to, Vec3d tangent_to) {
    const auto reflect = [](Vec3d v, Vec3d across) {
        const double l = length_squared(across);
        return l > 1e-300 ? v - across * (2 * dot(across, v) / l) : v;
    };
    const Vec3d step = to - from;
    if (length_squared(step) < 1e-300) return turned(normal, tangent_from, tangent_to);
    const Vec3d tangent = reflect(tangent_from, step);
    const Vec3d n = reflect(reflect(normal, step), tangent_to - tangent);
    return normalized(n - tangent_to * dot(n, tangent_to), normal);
}

}  // namespace coppice
