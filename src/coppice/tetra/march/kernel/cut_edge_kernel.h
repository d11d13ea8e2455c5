#pragma once

#include <algorithm>
#include <cstdint>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"

namespace coppice::tetra_kernel {

/// A held vertex that is outside or near the surface according to the field.
struct WeakVertex {
    std::uint32_t vertex;  ///< fine vertex
    float radius;          ///< [m] of the axis there
    float away;            ///< [m] distance from the axis, before it was moved
    float height;          ///< height of the profile at the moved position
};

/// Minimum thickness of a branch around a held vertex with an axis near the surface.
inline constexpr float kThinnest = 0.5f;  // [radii]

/// A fine edge between inside and outside, the interval of it that contains the crossing, and the heights at
/// the ends of that interval.
struct CutEdge {
    /// [m] The whole edge.
    /// @{
    Vec3 a, b;
    /// @}
    /// Shares of the edge, and the heights there.
    /// @{
    float low, high, at_low, at_high;
    /// @}
    /// Shares of the edge between which the crossing must be.
    /// @{
    float least, most;
    /// @}
    float share = 0.5f;  ///< current estimate of the crossing
    int last = 0;        ///< the end moved last: -1 low, 1 high

    /// Creates the whole edge, between vertices of these heights.
    COPPICE_HOST_DEVICE static CutEdge between(Vec3 a, Vec3 b, float at_a, float at_b, float clearance) {
        return {a, b, 0, 1, at_a, at_b, clearance, 1 - clearance};
    }

    /// Returns the crossing according to linear interpolation of the heights.
    COPPICE_HOST_DEVICE Vec3 point() {
        const double fall = double(at_low) - at_high;
        const float t = fall == 0 ? 0.5f : std::clamp(static_cast<float>(at_low / fall), 0.0f, 1.0f);
        share = std::clamp(low + (high - low) * t, least, most);
        return lerp(a, b, share);
    }

    /// Ensures a minimum thickness of a branch around the end that holds its axis, at distance `away`. If
    /// this end is outside according to the field, the field does not determine the thickness, and the axis
    /// does.
    COPPICE_HOST_DEVICE void thicken(const WeakVertex& held, float height, float away, bool at_a) {
        const bool sunken = height <= 0;
        const float thick =
            sunken ? std::max(held.radius - away, kThinnest * held.radius) : kThinnest * held.radius;
        const float part = std::clamp(thick / distance(a, b), least, 0.5f);
        if (at_a || sunken) least = at_a ? part : 1 - part;
        if (!at_a || sunken) most = at_a ? part : 1 - part;
    }

    /// Regula falsi step; the height at an end that stays for the second time is reduced according to the
    /// curvature [Anderson1973]. `height` is the height at the last point.
    COPPICE_HOST_DEVICE void narrow(float height) {
        const bool moves_low = (height > 0) == (at_low > 0);
        float &moved = moves_low ? at_low : at_high, &stays = moves_low ? at_high : at_low;
        const int end = moves_low ? -1 : 1;
        if (last == end) {
            const float part = 1 - height / moved;
            stays *= part > 0 ? part : 0.5f;
        }
        (moves_low ? low : high) = share;
        moved = height;
        last = end;
    }
};

}  // namespace coppice::tetra_kernel
