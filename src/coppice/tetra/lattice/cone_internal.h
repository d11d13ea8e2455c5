#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A segment from its thinner end on: balls about low + t along of radius radius + t growth, t in [0, 1].
/// Relative to some corner of space, in double precision.
struct Cone {
    Vec3d low, along;
    double radius = 0, growth = 0;
    double along_squared = 0;

    Cone() = default;
    Cone(const Segment& s, Vec3d corner) {
        const bool turned = s.radius_b < s.radius_a;
        const Vec3d a = Vec3d(s.a) - corner, b = Vec3d(s.b) - corner;
        low = turned ? b : a;
        along = turned ? a - b : b - a;
        radius = std::min(s.radius_a, s.radius_b);
        growth = std::max(s.radius_a, s.radius_b) - radius;
        along_squared = length_squared(along);
    }

    /// Parameter of the point of the axis that is nearest.
    double nearest(Vec3d p) const {
        return along_squared > 0 ? std::clamp(dot(p - low, along) / along_squared, 0.0, 1.0) : 0.0;
    }
    /// Parameter of the ball, of those `times` as large, to whose surface p is nearest: beyond the foot of p
    /// on the axis, towards the thicker end, as the cone's flank is aslant.
    double facing(Vec3d p, double times) const {
        const double g = times * growth, steep = along_squared - g * g;
        if (steep <= 0) return 1;
        const Vec3d w = p - low;
        const double foot = dot(w, along) / along_squared;
        if (g <= 0) return std::clamp(foot, 0.0, 1.0);
        const double away = std::sqrt(std::max(0.0, length_squared(w) - foot * foot * along_squared) / steep);
        return std::clamp(foot + away * g / std::sqrt(along_squared), 0.0, 1.0);
    }
    double radius_at(double t) const { return radius + t * growth; }

    /// Greatest n . p over the points p of the balls `times` as large, for n of length n_length.
    double support(Vec3d n, double n_length, double times) const {
        return dot(low, n) + times * radius * n_length +
               std::max(0.0, dot(along, n) + times * growth * n_length);
    }
};

/// Radius of the thinnest ball of the cone that, `times` as large, meets the ball about `center`; none when
/// all miss it. The condition |center - low - t along| <= times (radius + t growth) + reach, squared, is a
/// quadratic in t of which the first root counts.
inline std::optional<double> thinnest_meeting(const Cone& cone, double times, Vec3d center, double reach) {
    const Vec3d w = center - cone.low;
    const double r = times * cone.radius + reach, g = times * cone.growth;
    const double c = dot(w, w) - r * r;
    if (c <= 0) return cone.radius;
    const double b = dot(w, cone.along) + r * g, a = cone.along_squared - g * g;
    const double under_root = b * b - a * c;
    if (under_root < 0 || (b <= 0 && a >= 0)) return std::nullopt;
    const double down = b + std::sqrt(under_root);
    if (!(c <= down)) return std::nullopt;
    return cone.radius_at(c / down);
}

/// Whether the ball about `center` lies within one of the balls of the cone, `times` as large.
inline bool swallows(const Cone& cone, double times, Vec3d center, double reach) {
    // From the thicker end on.
    const double g = times * cone.growth, r = times * (cone.radius + cone.growth) - reach;
    if (r <= 0) return false;
    const Vec3d w = center - cone.low - cone.along;
    const double c = dot(w, w) - r * r;
    if (c <= 0) return true;
    const double b = -dot(w, cone.along) - r * g, a = cone.along_squared - g * g;
    const double under_root = b * b - a * c;
    if (under_root < 0) return false;
    const double down = b + std::sqrt(under_root);
    return c <= down && r - (c / down) * g >= 0;
}

/// Whether a plane across the shortest way from the cone to `middle` parts the cone, `times` as large, from a
/// convex body around `middle`; lowest(n, |n|) is the least n . p over the body's points. May be false
/// although they are apart.
template <class Lowest>
bool parted(const Cone& cone, double times, Vec3d middle, const Lowest& lowest) {
    const Vec3d n = middle - (cone.low + cone.facing(middle, times) * cone.along);
    const double n_length = length(n);
    return n_length > 0 && lowest(n, n_length) > cone.support(n, n_length, times);
}

}  // namespace coppice
