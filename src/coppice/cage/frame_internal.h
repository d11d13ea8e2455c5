#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "coppice/base/kernel/fast_atan2.h"
#include "coppice/base/vec.h"

namespace coppice::cage_internal {

/// Four vertices around a branch, counter-clockwise seen against its direction (from outside, looking at the
/// node).
using Ring = std::array<std::uint32_t, 4>;

/// Orthonormal frame of an axis: x, y perpendicular to it, right-handed.
struct Frame {
    Vec3 axis, x, y;

    explicit Frame(Vec3 axis_) : axis(axis_), x(perpendicular(axis_)), y(cross(axis_, x)) {}
    Frame(Vec3 axis_, Vec3 x_) : axis(axis_), x(x_), y(cross(axis_, x_)) {}

    Vec3 around(float azimuth) const { return x * std::cos(azimuth) + y * std::sin(azimuth); }
    float azimuth(Vec3 v) const { return fast_atan2(dot(v, y), dot(v, x)); }

    /// Returns the four directions a quarter turn apart that begin at the azimuth.
    std::array<Vec3, 4> quarters(float azimuth) const { return quarters_from(around(azimuth)); }
    std::array<Vec3, 4> quarters_from(Vec3 u) const {
        const Vec3 v = cross(axis, u);
        return {u, v, -u, -v};
    }

    /// The mean direction of four points around a center, each turned back by its number of quarter turns, as
    /// a vector of any length, and their distances from the axis. Needs no arctangent.
    struct Quarters {
        float x = 0, y = 0;
        std::array<float, 4> off_axis{};
    };
    template <class Points>
    Quarters compute_quarters(const Points& points, Vec3 center) const {
        Quarters out;
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 v = points(k) - center;
            float a = dot(v, x), b = dot(v, y);
            out.off_axis[k] = std::sqrt(a * a + b * b);
            const float scale = 1 / std::max(out.off_axis[k], 1e-30f);
            if (k & 1) {
                const float turned = b;
                b = -a;
                a = turned;
            }
            const float sign = k & 2 ? -scale : scale;
            out.x += sign * a;
            out.y += sign * b;
        }
        return out;
    }

    template <class Points>
    float quarters_azimuth(const Points& points, Vec3 center) const {
        const Quarters mean = compute_quarters(points, center);
        return fast_atan2(mean.y, mean.x);
    }

    /// Returns the frame turned by the minimum rotation that brings its axis to `to` [Wang2008].
    Frame turned(Vec3 to) const {
        const float c = dot(axis, to);
        if (c < -0.9999f) return Frame(to, x);  // half a turn about x
        const Vec3 h = axis + to;
        const Vec3 turned_x = x - h * (dot(to, x) / (1 + c));
        return Frame(to, normalized(turned_x - to * dot(to, turned_x), perpendicular(to)));
    }
};

inline float angle_between(Vec3 a, Vec3 b) { return fast_atan2(length(cross(a, b)), dot(a, b)); }

/// Wraps an angle to [-pi, pi].
inline float wrap_angle(float a) { return std::remainder(a, 2 * 3.14159265358979f); }

}  // namespace coppice::cage_internal
