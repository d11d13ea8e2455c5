#pragma once

#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/vec.h"

namespace coppice {

/// A tapered segment with round ends: a ball that moves from a to b while its radius runs linearly. Points of
/// the axis are named by a parameter, 0 at a and 1 at b.
///
/// The surface is taken where the distance from the axis is the radius at the foot, the nearest point of the
/// axis. (The envelope of the balls lies a little further out, where the cone tapers with slope s: a point at
/// distance d from the axis is d s^2 / 2 nearer to that.)
template <class T>
struct BasicRoundCone {
    BasicVec3<T> a;     ///< [m] one end of the axis
    BasicVec3<T> axis;  ///< [m] from a to b, the other end
    T radius_a{};       ///< [m] at a
    T growth{};         ///< [m] the radius at b less that at a

    /// A point of the axis, as seen from p.
    struct Foot {
        T t;                  ///< its parameter
        BasicVec3<T> offset;  ///< [m] from there to p
        T radius;             ///< [m] there

        T distance() const { return length(offset); }              ///< [m] of p from the axis
        T signed_distance() const { return distance() - radius; }  ///< [m] of p from the surface, < 0 inside
        /// Square of the distance from the axis in radii: < 1 inside.
        T relative_squared() const { return length_squared(offset) / (radius * radius); }
    };

    BasicVec3<T> b() const { return a + axis; }             ///< [m]
    T radius_b() const { return radius_a + growth; }        ///< [m]
    BasicVec3<T> point(T t) const { return a + axis * t; }  ///< [m] of the axis
    T radius(T t) const { return radius_a + growth * t; }   ///< [m]

    /// The parameter of the point of the line through the axis that is nearest to p, beyond the ends too; 0
    /// for an axis without length.
    T line_parameter(BasicVec3<T> p) const {
        const T squared = length_squared(axis);
        return squared > 0 ? dot(p - a, axis) / squared : T{0};
    }
    /// The point of the axis nearest to p. Of an axis without length the end with the greater ball.
    Foot foot(BasicVec3<T> p) const {
        return foot_at(closest_parameter(p, a, axis, growth < 0 ? T{0} : T{1}), p);
    }
    /// The point of the axis with this parameter.
    Foot foot_at(T t, BasicVec3<T> p) const { return {t, p - point(t), radius(t)}; }
};

/// In double precision, which distances need.
using RoundCone = BasicRoundCone<double>;

/// From the ball about a to the ball about b.
template <class T>
BasicRoundCone<T> round_cone(BasicVec3<T> a, BasicVec3<T> b, T radius_a, T radius_b) {
    return {a, b - a, radius_a, radius_b - radius_a};
}

}  // namespace coppice
