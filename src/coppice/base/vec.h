#pragma once

#include <cmath>

#include "coppice/base/kernel/host_device.h"

namespace coppice {

/// A point or direction in space: metres in world space, Z up, right-handed, unless stated otherwise.
template <class T>
struct BasicVec3 {
    T x{};  ///< along the first axis
    T y{};  ///< along the second axis
    T z{};  ///< along the third axis: up

    constexpr BasicVec3() = default;  ///< 0, 0, 0
    /// Creates a vector with these coordinates.
    constexpr BasicVec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
    /// Converts from another precision.
    template <class U>
    constexpr explicit BasicVec3(const BasicVec3<U>& v)
        : x(static_cast<T>(v.x)), y(static_cast<T>(v.y)), z(static_cast<T>(v.z)) {}

    /// Returns the coordinate along an axis: 0, 1 or 2.
    /// @{
    constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    constexpr T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    /// @}

    /// Operates on each coordinate.
    /// @{
    constexpr BasicVec3& operator+=(BasicVec3 b) { return *this = *this + b; }
    constexpr BasicVec3& operator-=(BasicVec3 b) { return *this = *this - b; }
    constexpr BasicVec3& operator*=(T s) { return *this = *this * s; }

    friend constexpr BasicVec3 operator+(BasicVec3 a, BasicVec3 b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend constexpr BasicVec3 operator-(BasicVec3 a, BasicVec3 b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    friend constexpr BasicVec3 operator-(BasicVec3 a) { return {-a.x, -a.y, -a.z}; }
    friend constexpr BasicVec3 operator*(BasicVec3 a, T s) { return {a.x * s, a.y * s, a.z * s}; }
    friend constexpr BasicVec3 operator*(T s, BasicVec3 a) { return a * s; }
    friend constexpr BasicVec3 operator/(BasicVec3 a, T s) { return a * (T{1} / s); }
    friend constexpr bool operator==(const BasicVec3&, const BasicVec3&) = default;
    /// @}
};

/// Type in which positions are stored.
using Vec3 = BasicVec3<float>;
/// Type of computations for which float is not sufficient, and of georeferenced origins.
using Vec3d = BasicVec3<double>;

/// Returns the scalar product.
template <class T>
constexpr T dot(BasicVec3<T> a, BasicVec3<T> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Returns the vector product, right-handed.
template <class T>
constexpr BasicVec3<T> cross(BasicVec3<T> a, BasicVec3<T> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Returns dot(a, a).
template <class T>
constexpr T length_squared(BasicVec3<T> a) {
    return dot(a, a);
}

/// [m] Returns the length of a position or a difference of positions.
template <class T>
COPPICE_HOST_DEVICE T length(BasicVec3<T> a) {
    return std::sqrt(dot(a, a));
}

/// Returns the length of a - b.
template <class T>
COPPICE_HOST_DEVICE T distance(BasicVec3<T> a, BasicVec3<T> b) {
    return length(a - b);
}

/// Returns a + t (b - a).
template <class T>
constexpr BasicVec3<T> lerp(BasicVec3<T> a, BasicVec3<T> b, T t) {
    return a + (b - a) * t;
}

/// Returns the unit vector along a, or `fallback` if a is too short to have a direction.
template <class T>
COPPICE_HOST_DEVICE BasicVec3<T> normalized(BasicVec3<T> a, BasicVec3<T> fallback = {0, 0, 1}) {
    const T l = length(a);
    return l > T{1e-30} ? a / l : fallback;
}

/// Returns a unit vector perpendicular to the unit vector a; continuous except where a points along -z.
/// Source: [Duff2017].
template <class T>
COPPICE_HOST_DEVICE BasicVec3<T> perpendicular(BasicVec3<T> a) {
    const T sign = std::copysign(T{1}, a.z);
    const T k = T{-1} / (sign + a.z);
    return {T{1} + sign * a.x * a.x * k, sign * a.x * a.y * k, -sign * a.x};
}

/// Returns whether no coordinate is infinite or NaN.
template <class T>
COPPICE_HOST_DEVICE bool is_finite(BasicVec3<T> a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace coppice
