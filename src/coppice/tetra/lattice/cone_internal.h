#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

// Queries on a round cone, relative to an arbitrary origin, with balls that grow from a to b: growth >= 0.
// The parameter `times` multiplies all its radii.

/// Returns the cone of a segment, oriented from its thinner end to its thicker one.
inline RoundCone growing_cone(const Segment& s, Vec3d corner) {
    const Vec3d a = Vec3d(s.a) - corner, b = Vec3d(s.b) - corner;
    return s.radius_b < s.radius_a ? round_cone<double>(b, a, s.radius_b, s.radius_a)
                                   : round_cone<double>(a, b, s.radius_a, s.radius_b);
}

/// Returns the parameter of the ball with the surface closest to p: beyond the closest point on the axis,
/// towards the thicker end, because the surface of the cone is oblique.
inline double nearest_ball(const RoundCone& cone, double times, Vec3d p) {
    const double squared = length_squared(cone.axis), g = times * cone.growth, steep = squared - g * g;
    if (steep <= 0) return 1;
    const double closest_parameter = cone.line_parameter(p);
    if (g <= 0) return std::clamp(closest_parameter, 0.0, 1.0);
    const double away = std::sqrt(
        std::max(0.0, length_squared(p - cone.a) - closest_parameter * closest_parameter * squared) / steep);
    return std::clamp(closest_parameter + away * g / std::sqrt(squared), 0.0, 1.0);
}

/// Returns the maximum of n . p over the points p of the balls, for n of length n_length (the support
/// function).
inline double support(const RoundCone& cone, double times, Vec3d n, double n_length) {
    return dot(cone.a, n) + times * cone.radius_a * n_length +
           std::max(0.0, dot(cone.axis, n) + times * cone.growth * n_length);
}

/// Returns the radius of the thinnest ball of the cone that, `times` as large, intersects the ball around
/// `center`; empty if no ball does. The condition |center - low - t along| <= times (radius + t growth) +
/// reach, squared, is a quadratic in t; its first root is the solution.
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

/// Returns whether the ball around `center` is inside one of the balls of the cone, `times` as large.
inline bool holds_ball(const RoundCone& cone, double times, Vec3d center, double reach) {
    // Searches from the thicker end.
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

/// Returns whether a plane perpendicular to the shortest path from the cone to `middle` separates the cone,
/// `times` as large, from a convex body around `middle`; lowest(n, |n|) is the minimum of n . p over the
/// points of the body. May return false although they are disjoint.
template <class Lowest>
bool separated(const RoundCone& cone, double times, Vec3d middle, const Lowest& lowest) {
    const Vec3d n = middle - cone.point(nearest_ball(cone, times, middle));
    const double n_length = length(n);
    return n_length > 0 && lowest(n, n_length) > support(cone, times, n, n_length);
}

}  // namespace coppice
