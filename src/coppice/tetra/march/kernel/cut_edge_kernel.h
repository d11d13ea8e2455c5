#pragma once

#include <algorithm>
#include <cstdint>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"

namespace coppice::tetra_kernel {

/// A held vertex that the field puts outside or near to the surface.
struct WeakVertex {
    std::uint32_t vertex;  ///< a fine one
    float radius;          ///< [m] of the axis there
    float away;            ///< [m] from the axis, where it was before it was moved
    float height;          ///< of the profile at the place that it was moved to
};

/// Where a vertex holds an axis that lies near the surface, the branch is not thinner than this.
inline constexpr float kThinnest = 0.5f;  // [radii]

/// A fine edge between inside and outside, the part of it that the surface crosses, and the heights at the
/// ends of that part.
struct CutEdge {
    /// [m] The whole edge.
    /// @{
    Vec3 a, b;
    /// @}
    /// Shares of the edge, and the heights there.
    /// @{
    float low, high, at_low, at_high;
    /// @}
    /// Shares of the edge: it may cross nowhere else.
    /// @{
    float least, most;
    /// @}
    float share = 0.5f;  ///< where the surface is taken to cross
    int last = 0;        ///< the end moved last: -1 low, 1 high

    /// The whole edge, between vertices of these heights.
    COPPICE_HOST_DEVICE static CutEdge between(Vec3 a, Vec3 b, float at_a, float at_b, float clearance) {
        return {a, b, 0, 1, at_a, at_b, clearance, 1 - clearance};
    }

    /// Where the surface would cross if heights ran straight.
    COPPICE_HOST_DEVICE Vec3 point() {
        const double fall = double(at_low) - at_high;
        const float t = fall == 0 ? 0.5f : std::clamp(static_cast<float>(at_low / fall), 0.0f, 1.0f);
        share = std::clamp(low + (high - low) * t, least, most);
        return lerp(a, b, share);
    }

    /// Keeps a branch thick about the end that holds its axis, and is `away` from it. Where the field says
    /// that this end is outside, it says nothing of how thick, but the axis does.
    COPPICE_HOST_DEVICE void thicken(const WeakVertex& held, float height, float away, bool at_a) {
        const bool sunken = height <= 0;
        const float thick =
            sunken ? std::max(held.radius - away, kThinnest * held.radius) : kThinnest * held.radius;
        const float part = std::clamp(thick / distance(a, b), least, 0.5f);
        if (at_a || sunken) least = at_a ? part : 1 - part;
        if (!at_a || sunken) most = at_a ? part : 1 - part;
    }

    /// Regula falsi; an end that stays for the second time counts for less, by as much as the curve bends
    /// [Anderson1973]. `height` is that at the last point.
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
