#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "coppice/base/vec.h"

namespace coppice::control {

/// Four vertices around a branch, counter-clockwise seen against its direction (from outside, looking at the
/// node).
using Ring = std::array<std::uint32_t, 4>;

/// Orthonormal frame about an axis: x, y perpendicular to it, right-handed.
struct Frame {
    Vec3 axis, x, y;

    explicit Frame(Vec3 axis_) : axis(axis_), x(perpendicular(axis_)), y(cross(axis_, x)) {}
    Frame(Vec3 axis_, Vec3 x_) : axis(axis_), x(x_), y(cross(axis_, x_)) {}

    Vec3 around(float azimuth) const { return x * std::cos(azimuth) + y * std::sin(azimuth); }
    float azimuth(Vec3 v) const { return std::atan2(dot(v, y), dot(v, x)); }

    /// The four directions a quarter turn apart that begin at the azimuth.
    std::array<Vec3, 4> quarters(float azimuth) const {
        const Vec3 u = around(azimuth), v = cross(axis, u);
        return {u, v, -u, -v};
    }

    /// Mean azimuth of four points about `center`, each turned back by its number of quarter turns; no angle
    /// is taken but the last, so that it is cheap.
    template <class Points>
    float quarters_azimuth(const Points& points, Vec3 center) const {
        float c = 0, s = 0;
        for (int k = 0; k < 4; ++k) {
            const Vec3 v = points(k) - center;
            float a = dot(v, x), b = dot(v, y);
            const float scale = 1 / std::max(std::sqrt(a * a + b * b), 1e-30f);
            if (k & 1) {
                const float turned = b;
                b = -a;
                a = turned;
            }
            const float sign = k & 2 ? -scale : scale;
            c += sign * a;
            s += sign * b;
        }
        return std::atan2(s, c);
    }

    /// The frame turned by the least rotation that brings its axis to `to` [Wang2008].
    Frame turned(Vec3 to) const {
        const float c = dot(axis, to);
        if (c < -0.9999f) return Frame(to, x);  // half a turn about x
        const Vec3 h = axis + to;
        const Vec3 turned_x = x - h * (dot(to, x) / (1 + c));
        return Frame(to, normalized(turned_x - to * dot(to, turned_x), perpendicular(to)));
    }
};

inline float angle_between(Vec3 a, Vec3 b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

/// Wraps an angle to [-pi, pi].
inline float wrap_angle(float a) { return std::remainder(a, 2 * 3.14159265358979f); }

}  // namespace coppice::control
