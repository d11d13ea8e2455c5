#pragma once

#include <cmath>

namespace coppice {

/// A point or direction in space: metres in world space, Z up, right-handed, unless said otherwise.
template <class T>
struct BasicVec3 {
    T x{}, y{}, z{};

    constexpr BasicVec3() = default;
    constexpr BasicVec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
    template <class U>
    constexpr explicit BasicVec3(const BasicVec3<U>& v)
        : x(static_cast<T>(v.x)), y(static_cast<T>(v.y)), z(static_cast<T>(v.z)) {}

    constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    constexpr T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }

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
};

using Vec3 = BasicVec3<float>;
using Vec3d = BasicVec3<double>;

template <class T>
constexpr T dot(BasicVec3<T> a, BasicVec3<T> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
constexpr BasicVec3<T> cross(BasicVec3<T> a, BasicVec3<T> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
constexpr T length_squared(BasicVec3<T> a) {
    return dot(a, a);
}

template <class T>
T length(BasicVec3<T> a) {
    return std::sqrt(dot(a, a));
}

template <class T>
T distance(BasicVec3<T> a, BasicVec3<T> b) {
    return length(a - b);
}

/// a + t (b - a).
template <class T>
constexpr BasicVec3<T> lerp(BasicVec3<T> a, BasicVec3<T> b, T t) {
    return a + (b - a) * t;
}

/// The unit vector along a, or `fallback` when a is too short to have a direction.
template <class T>
BasicVec3<T> normalized(BasicVec3<T> a, BasicVec3<T> fallback = {0, 0, 1}) {
    const T l = length(a);
    return l > T{1e-30} ? a / l : fallback;
}

/// Some unit vector perpendicular to the unit vector a; continuous except where a points along -z.
/// Source: [Duff2017].
template <class T>
BasicVec3<T> perpendicular(BasicVec3<T> a) {
    const T sign = std::copysign(T{1}, a.z);
    const T k = T{-1} / (sign + a.z);
    return {T{1} + sign * a.x * a.x * k, sign * a.x * a.y * k, -sign * a.x};
}

template <class T>
bool is_finite(BasicVec3<T> a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace coppice
