#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "coppice/implicit/field_ref.h"

namespace coppice {

/// Minus the signed distance to a sphere; the iso value is 0.
struct SphereField {
    Vec3 center;
    float radius;

    float level() const { return 0; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec3 to = center - points[i];
            out[i] = {radius - length(to), normalized(to)};
        }
    }
};

/// Minus the signed distance to a torus about the z axis; the iso value is 0.
struct TorusField {
    float ring, tube;

    float level() const { return 0; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec3 p = points[i];
            const Vec3 to = normalized(Vec3{p.x, p.y, 0}, {1, 0, 0}) * ring - p;
            out[i] = {tube - length(to), normalized(to)};
        }
    }
};

/// The minimum and maximum of a signed field along all segments, at 200 points each.
struct FieldRange {
    float low = INFINITY, high = -INFINITY;
};

template <class SkeletonType, class Field>
FieldRange range_along(const SkeletonType& s, const Field& field) {
    FieldRange range;
    for (const auto n : nodes(s)) {
        const Vec3 b = s.position(n), a = s.is_root(n) ? b : s.position(s.parent(n));
        for (int i = 0; i <= 200; ++i) {
            const Vec3 p = lerp(a, b, static_cast<float>(i) / 200);
            FieldSample v;
            field.sample(0, {&p, 1}, {&v, 1});
            range.low = std::min(range.low, v.value);
            range.high = std::max(range.high, v.value);
        }
    }
    return range;
}

}  // namespace coppice
