#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

// Queries on a round cone, relative to some corner of space, whose balls grow from a to b: growth >= 0. With
// `times`, all its balls are so many times as large.

/// A segment from its thinner end on.
inline RoundCone growing_cone(const Segment& s, Vec3d corner) {
    const Vec3d a = Vec3d(s.a) - corner, b = Vec3d(s.b) - corner;
    return s.radius_b < s.radius_a ? round_cone<double>(b, a, s.radius_b, s.radius_a)
                                   : round_cone<double>(a, b, s.radius_a, s.radius_b);
}

/// Parameter of the ball to whose surface p is nearest: beyond the foot of p on the axis, towards the thicker
/// end, as the cone's flank is aslant.
inline double nearest_ball(const RoundCone& cone, double times, Vec3d p) {
    const double squared = length_squared(cone.axis), g = times * cone.growth, steep = squared - g * g;
    if (steep <= 0) return 1;
    const double foot = cone.line_parameter(p);
    if (g <= 0) return std::clamp(foot, 0.0, 1.0);
    const double away = std::sqrt(std::max(0.0, length_squared(p - cone.a) - foot * foot * squared) / steep);
    return std::clamp(foot + away * g / std::sqrt(squared), 0.0, 1.0);
}

/// Greatest n . p over the points p of the balls, for n of length n_length (the support function).
inline double support(const RoundCone& cone, double times, Vec3d n, double n_length) {
    return dot(cone.a, n) + times * cone.radius_a * n_length +
           std::max(0.0, dot(cone.axis, n) + times * cone.growth * n_length);
}

/// Radius of the thinnest ball of the cone that, `times` as large, meets the ball about `center`; none when
/// all miss it. The condition |center - low - t along| <= times (radius + t growth) + reach, squared, is a
/// quadratic in t of which the first root counts.
inline std::optional<double> thinnest_ball_meeting(const RoundCone& cone, double times, Vec3d center,
                                                   double reach) {
    const Vec3d w = center - cone.a;
    const double r = times * cone.radius_a + reach, g = times * cone.growth;
    const double c = dot(w, w) - r * r;
    if (c <= 0) return cone.radius_a;
    const double b = dot(w, cone.axis) + r * g, a = length_squared(cone.axis) - g * g;
    const double under_root = b * b - a * c;
    if (under_root < 0 || (b <= 0 && a >= 0)) return std::nullopt;
    const double down = b + std::sqrt(under_root);
    if (!(c <= down)) return std::nullopt;
    return cone.radius(c / down);
}

/// Whether the ball about `center` lies within one of the balls of the cone, `times` as large.
inline bool holds_ball(const RoundCone& cone, double times, Vec3d center, double reach) {
    // From the thicker end on.
    const double g = times * cone.growth, r = times * cone.radius_b() - reach;
    if (r <= 0) return false;
    const Vec3d w = center - cone.a - cone.axis;
    const double c = dot(w, w) - r * r;
    if (c <= 0) return true;
    const double b = -dot(w, cone.axis) - r * g, a = length_squared(cone.axis) - g * g;
    const double under_root = b * b - a * c;
    if (under_root < 0) return false;
    const double down = b + std::sqrt(under_root);
    return c <= down && r - (c / down) * g >= 0;
}

/// Whether a plane across the shortest way from the cone to `middle` parts the cone, `times` as large, from a
/// convex body around `middle`; lowest(n, |n|) is the least n . p over the body's points. May be false
/// although they are apart.
template <class Lowest>
bool separated(const RoundCone& cone, double times, Vec3d middle, const Lowest& lowest) {
    const Vec3d n = middle - cone.point(nearest_ball(cone, times, middle));
    const double n_length = length(n);
    return n_length > 0 && lowest(n, n_length) > support(cone, times, n, n_length);
}

}  // namespace coppice
