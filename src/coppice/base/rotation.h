#pragma once

#include <cmath>

#include "coppice/base/vec.h"

namespace coppice {

/// A rotation as a unit quaternion: similar rotations are averaged by addition.
struct Rotation {
    double w = 1;  ///< cosine of half the angle
    Vec3d v;       ///< axis times the sine of half the angle

    /// Returns the point rotated about the origin.
    Vec3d operator()(Vec3d p) const {
        const Vec3d t = cross(v, p) * 2.0;
        return p + t * w + cross(v, t);
    }
    /// Rotates by `b`, then by `a`.
    friend Rotation operator*(const Rotation& a, const Rotation& b) {
        return {a.w * b.w - dot(a.v, b.v), b.v * a.w + a.v * b.w + cross(a.v, b.v)};
    }
    friend bool operator==(const Rotation&, const Rotation&) = default;  ///< compares the numbers
};

/// Returns the inverse rotation.
inline Rotation inverse(const Rotation& r) { return {r.w, r.v * -1.0}; }

/// Normalises a quaternion; returns the identity for one of length zero.
inline Rotation unit(Rotation r) {
    const double l = std::sqrt(r.w * r.w + length_squared(r.v));
    return l > 1e-30 ? Rotation{r.w / l, r.v / l} : Rotation{};
}

/// Returns the rotation about a unit axis, counter-clockwise when viewed against the axis; the angle is in
/// radians.
inline Rotation rotation_about(Vec3d unit_axis, double angle) {
    return {std::cos(angle / 2), unit_axis * std::sin(angle / 2)};
}

/// Returns the rotation about the direction of a vector by its length in radians.
inline Rotation rotation_by(Vec3d turn) {
    const double angle = length(turn);
    return angle > 1e-12 ? rotation_about(turn / angle, angle) : Rotation{};
}

/// Returns the smallest rotation from one direction to another.
inline Rotation rotation_between(Vec3d from, Vec3d to) {
    const Vec3d a = normalized(from), b = normalized(to);
    const double c = dot(a, b);
    if (c < -1 + 1e-12) return {0, perpendicular(a)};
    return unit({1 + c, cross(a, b)});
}

/// Returns the rotation with the one of its two equivalent signs that is closer to another rotation.
inline Rotation signed_as(const Rotation& r, const Rotation& other) {
    return r.w * other.w + dot(r.v, other.v) < 0 ? Rotation{-r.w, r.v * -1.0} : r;
}

/// Returns the rotation half-way between two.
inline Rotation between(const Rotation& a, const Rotation& b) {
    const Rotation c = signed_as(b, a);
    return unit({a.w + c.w, a.v + c.v});
}

}  // namespace coppice
