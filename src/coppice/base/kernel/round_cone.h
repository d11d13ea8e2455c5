#pragma once

#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/vec.h"

namespace coppice {

/// A tapered segment with round ends: a ball that moves from a to b while its radius changes linearly. Points
/// of the axis are identified by a parameter, 0 at a and 1 at b.
///
/// The surface is where the distance from the axis equals the radius at the closest point of the axis. (The
/// envelope of the balls is slightly larger where the cone tapers with slope s: a point at distance d from
/// the axis is d s^2 / 2 closer to it.)
template <class T>
struct BasicRoundCone {
    BasicVec3<T> a;     ///< [m] start of the axis
    BasicVec3<T> axis;  ///< [m] vector from a to b, the end of the axis
    T radius_a{};       ///< [m] at a
    T growth{};         ///< [m] radius at b minus radius at a

    /// A point of the axis relative to a point p.
    struct ClosestPoint {
        T t;                  ///< its parameter
        BasicVec3<T> offset;  ///< [m] vector from it to p
        T radius;             ///< [m] radius of the cone there

        T distance() const { return length(offset); }              ///< [m] of p from the axis
        T signed_distance() const { return distance() - radius; }  ///< [m] of p from the surface, < 0 inside
        /// Squared distance from the axis in radii: < 1 inside.
        T relative_squared() const { return length_squared(offset) / (radius * radius); }
    };

    BasicVec3<T> b() const { return a + axis; }             ///< [m]
    T radius_b() const { return radius_a + growth; }        ///< [m]
    BasicVec3<T> point(T t) const { return a + axis * t; }  ///< [m] of the axis
    T radius(T t) const { return radius_a + growth * t; }   ///< [m]

    /// Returns the parameter of the point closest to p on the infinite line through the axis; 0 for an axis
    /// of zero length.
    T line_parameter(BasicVec3<T> p) const {
        const T squared = length_squared(axis);
        return squared > 0 ? dot(p - a, axis) / squared : T{0};
    }
    /// Returns the point of the axis closest to p; for an axis of zero length the end with the larger ball.
    ClosestPoint closest_point(BasicVec3<T> p) const {
        return closest_point_at(closest_parameter(p, a, axis, growth < 0 ? T{0} : T{1}), p);
    }
    /// Returns the point of the axis with this parameter.
    ClosestPoint closest_point_at(T t, BasicVec3<T> p) const { return {t, p - point(t), radius(t)}; }
};

/// Double precision, as distances require.
using RoundCone = BasicRoundCone<double>;

/// Returns the cone from the ball about a to the ball about b.
template <class T>
BasicRoundCone<T> round_cone(BasicVec3<T> a, BasicVec3<T> b, T radius_a, T radius_b) {
    return {a, b - a, radius_a, radius_b - radius_a};
}

}  // namespace coppice
