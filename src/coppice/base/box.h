#pragma once

#include <algorithm>
#include <limits>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"

namespace coppice {

/// An axis-aligned box; the default one is empty and grows by `extend`.
struct Box3 {
    /// low of the empty box; its high is the negative
    static constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Vec3 low{kInfinity, kInfinity, kInfinity};      ///< [m] the least corner
    Vec3 high{-kInfinity, -kInfinity, -kInfinity};  ///< [m] the greatest corner

    COPPICE_HOST_DEVICE bool empty() const { return !(low.x <= high.x); }  ///< nothing was put in yet
    COPPICE_HOST_DEVICE Vec3 size() const { return empty() ? Vec3{} : high - low; }  ///< [m] 0 where empty
    COPPICE_HOST_DEVICE Vec3 center() const { return 0.5f * (low + high); }  ///< [m] not a number where empty
    COPPICE_HOST_DEVICE float diagonal() const { return length(size()); }    ///< [m] 0 where empty

    /// Grows just so far that p lies in it.
    COPPICE_HOST_DEVICE void extend(Vec3 p) { extend(Box3{p, p}); }
    /// Grows just so far that b lies in it: not at all where b is empty.
    COPPICE_HOST_DEVICE void extend(const Box3& b) {
        low = {std::min(low.x, b.low.x), std::min(low.y, b.low.y), std::min(low.z, b.low.z)};
        high = {std::max(high.x, b.high.x), std::max(high.y, b.high.y), std::max(high.z, b.high.z)};
    }
    /// The box with `margin` [m] more on all six sides.
    COPPICE_HOST_DEVICE Box3 inflated(float margin) const {
        const Vec3 m{margin, margin, margin};
        return {low - m, high + m};
    }
    /// Whether the two share a point; boxes that only touch do.
    COPPICE_HOST_DEVICE bool overlaps(const Box3& b) const {
        return low.x <= b.high.x && b.low.x <= high.x && low.y <= b.high.y && b.low.y <= high.y &&
               low.z <= b.high.z && b.low.z <= high.z;
    }
};

/// The box of a segment with a ball of `radius` swept along it.
COPPICE_HOST_DEVICE inline Box3 capsule_box(Vec3 a, Vec3 b, float radius) {
    Box3 box;
    box.extend(a);
    box.extend(b);
    return box.inflated(radius);
}

}  // namespace coppice
