#pragma once

#include <algorithm>
#include <limits>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"

namespace coppice {

/// An axis-aligned box; empty by default, and grown by `extend`.
struct Box3 {
    /// low of the empty box; its high is the negative
    static constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Vec3 low{kInfinity, kInfinity, kInfinity};      ///< [m] minimum corner
    Vec3 high{-kInfinity, -kInfinity, -kInfinity};  ///< [m] maximum corner

    COPPICE_HOST_DEVICE bool empty() const { return !(low.x <= high.x); }  ///< true before the first extend()
    COPPICE_HOST_DEVICE Vec3 size() const { return empty() ? Vec3{} : high - low; }  ///< [m] 0 if empty
    COPPICE_HOST_DEVICE Vec3 center() const { return 0.5f * (low + high); }          ///< [m] NaN if empty
    COPPICE_HOST_DEVICE float diagonal() const { return length(size()); }            ///< [m] 0 if empty

    /// Grows the box to contain p.
    COPPICE_HOST_DEVICE void extend(Vec3 p) { extend(Box3{p, p}); }
    /// Grows the box to contain b; an empty b has no effect.
    COPPICE_HOST_DEVICE void extend(const Box3& b) {
        low = {std::min(low.x, b.low.x), std::min(low.y, b.low.y), std::min(low.z, b.low.z)};
        high = {std::max(high.x, b.high.x), std::max(high.y, b.high.y), std::max(high.z, b.high.z)};
    }
    /// Returns the box enlarged by `margin` [m] on all six sides.
    COPPICE_HOST_DEVICE Box3 inflated(float margin) const {
        const Vec3 m{margin, margin, margin};
        return {low - m, high + m};
    }
    /// Returns whether the boxes share a point; touching boxes do.
    COPPICE_HOST_DEVICE bool overlaps(const Box3& b) const {
        return low.x <= b.high.x && b.low.x <= high.x && low.y <= b.high.y && b.low.y <= high.y &&
               low.z <= b.high.z && b.low.z <= high.z;
    }
};

/// Returns the box of a segment with a ball of `radius` swept along it.
COPPICE_HOST_DEVICE inline Box3 capsule_box(Vec3 a, Vec3 b, float radius) {
    Box3 box;
    box.extend(a);
    box.extend(b);
    return box.inflated(radius);
}

}  // namespace coppice
