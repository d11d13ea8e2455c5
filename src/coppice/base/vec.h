#pragma once

#include <cmath>

#include "coppice/base/kernel/host_device.h"

namespace coppice {

/// A point or direction in space: metres in world space, Z up, right-handed, unless said otherwise.
template <class T>
struct BasicVec3 {
    T x{};  ///< along the first axis
    T y{};  ///< along the second
    T z{};  ///< along the third: up

    constexpr BasicVec3() = default;  ///< 0, 0, 0
    /// Of these coordinates.
    constexpr BasicVec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
    /// Of another precision.
    template <class U>
    constexpr explicit BasicVec3(const BasicVec3<U>& v)
        : x(static_cast<T>(v.x)), y(static_cast<T>(v.y)), z(static_cast<T>(v.z)) {}

    /// The coordinate along an axis: 0, 1 or 2.
    /// @{
    constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    constexpr T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    /// @}

    /// Coordinate by coordinate.
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

/// What positions are stored in.
using Vec3 = BasicVec3<float>;
/// What is computed in where float is not enough, and georeferenced origins.
using Vec3d = BasicVec3<double>;

/// The scalar product.
template <class T>
constexpr T dot(BasicVec3<T> a, BasicVec3<T> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The vector product, right-handed.
template <class T>
constexpr BasicVec3<T> cross(BasicVec3<T> a, BasicVec3<T> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// dot(a, a).
template <class T>
constexpr T length_squared(BasicVec3<T> a) {
    return dot(a, a);
}

/// [m] Of a position or a difference of positions.
template <class T>
COPPICE_HOST_DEVICE T length(BasicVec3<T> a) {
    return std::sqrt(dot(a, a));
}

/// Length of a - b.
template <class T>
COPPICE_HOST_DEVICE T distance(BasicVec3<T> a, BasicVec3<T> b) {
    return length(a - b);
}

/// a + t (b - a).
template <class T>
constexpr BasicVec3<T> lerp(BasicVec3<T> a, BasicVec3<T> b, T t) {
    return a + (b - a) * t;
}

/// The unit vector along a, or `fallback` when a is too short to have a direction.
template <class T>
COPPICE_HOST_DEVICE BasicVec3<T> normalized(BasicVec3<T> a, BasicVec3<T> fallback = {0, 0, 1}) {
    const T l = length(a);
    return l > T{1e-30} ? a / l : fallback;
}

/// Some unit vector perpendicular to the unit vector a; continuous except where a points along -z.
/// Source: [Duff2017].
template <class T>
COPPICE_HOST_DEVICE BasicVec3<T> perpendicular(BasicVec3<T> a) {
    const T sign = std::copysign(T{1}, a.z);
    const T k = T{-1} / (sign + a.z);
    return {T{1} + sign * a.x * a.x * k, sign * a.x * a.y * k, -sign * a.x};
}

/// No coordinate is infinite or not a number.
template <class T>
COPPICE_HOST_DEVICE bool is_finite(BasicVec3<T> a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace coppice
