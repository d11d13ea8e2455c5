#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace coppice::tetra_internal {

// Exact signs of determinants of integers: coordinates are below 2^25 in magnitude, so differences are below
// 2^26.

/// A point on the grid.
using GridPlace = std::array<std::int32_t, 3>;

__extension__ typedef __int128 Int128;

template <class T>
T determinant(const std::array<T, 3>& a, const std::array<T, 3>& b, const std::array<T, 3>& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// Returns the same sum with the absolute value of each term; the rounding error is proportional to it.
inline double size_of_terms(const std::array<double, 3>& a, const std::array<double, 3>& b,
                            const std::array<double, 3>& c) {
    const auto f = [](double x) { return std::abs(x); };
    return f(a[0]) * (f(b[1] * c[2]) + f(b[2] * c[1])) + f(a[1]) * (f(b[2] * c[0]) + f(b[0] * c[2])) +
           f(a[2]) * (f(b[0] * c[1]) + f(b[1] * c[0]));
}

template <class T>
std::array<T, 3> difference(const GridPlace& p, const GridPlace& from) {
    return {T(p[0]) - T(from[0]), T(p[1]) - T(from[1]), T(p[2]) - T(from[2])};
}

template <class T>
int compute_sign(T x) {
    return x > 0 ? 1 : x < 0 ? -1 : 0;
}

/// Returns the sign of the volume of a tetrahedron: of dot(cross(b - a, c - a), d - a).
inline int orientation(const GridPlace& a, const GridPlace& b, const GridPlace& c, const GridPlace& d) {
    const auto x = difference<double>(b, a), y = difference<double>(c, a), z = difference<double>(d, a);
    const double volume = determinant(x, y, z);
    if (std::abs(volume) > 1e-15 * size_of_terms(x, y, z)) return compute_sign(volume);
    return compute_sign(
        determinant(difference<Int128>(b, a), difference<Int128>(c, a), difference<Int128>(d, a)));
}

/// A grid point with a weight: the squared radius of its ball, which may be negative.
struct WeightedPlace {
    GridPlace at{};
    std::int64_t weight = 0;  ///< below 2^51 in magnitude
    double room = 0;          ///< of two points closer than the smaller of their rooms one is omitted
};

inline double distance_squared(const GridPlace& a, const GridPlace& b) {
    const auto d = difference<double>(a, b);
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/// Returns whether p is inside the sphere orthogonal to the balls of four corners of positive volume,
/// measured by power distance: if all weights are equal, the sphere through the four corners.
inline bool conflicts(const std::array<const WeightedPlace*, 4>& corners, const WeightedPlace& p) {
    std::array<std::array<double, 3>, 4> d;
    std::array<double, 4> lift{};
    for (std::size_t i = 0; i < 4; ++i) {
        d[i] = difference<double>(corners[i]->at, p.at);
        lift[i] = d[i][0] * d[i][0] + d[i][1] * d[i][1] + d[i][2] * d[i][2] +
                  static_cast<double>(p.weight - corners[i]->weight);
    }
    constexpr std::array<std::array<std::uint8_t, 3>, 4> kOthers{
        {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};
    double sum = 0, size = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& [j, k, l] = kOthers[i];
        const double sign = i % 2 == 0 ? -1 : 1;
        sum += sign * lift[i] * determinant(d[j], d[k], d[l]);
        size += std::abs(lift[i]) * size_of_terms(d[j], d[k], d[l]);
    }
    if (std::abs(sum) > 3e-15 * size) return sum < 0;
    // Lifts are up to 2^54 and determinants up to 2^81, so their products are computed in two halves.
    constexpr int kLow = 28;
    Int128 high = 0, low = 0;
    std::array<std::array<Int128, 3>, 4> e;
    for (std::size_t i = 0; i < 4; ++i) e[i] = difference<Int128>(corners[i]->at, p.at);
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& [j, k, l] = kOthers[i];
        const Int128 square =
            e[i][0] * e[i][0] + e[i][1] * e[i][1] + e[i][2] * e[i][2] + p.weight - corners[i]->weight;
        const Int128 minor = determinant(e[j], e[k], e[l]) * (i % 2 == 0 ? -1 : 1);
        const Int128 upper = square >> kLow;
        high += upper * minor;
        low += (square - (upper << kLow)) * minor;
    }
    high += low >> kLow;
    return high < 0;
}

}  // namespace coppice::tetra_internal
