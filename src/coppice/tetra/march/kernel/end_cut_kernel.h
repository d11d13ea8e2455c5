#pragma once

#include <algorithm>
#include <cmath>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"
#include "coppice/implicit/field_ref.h"

namespace coppice::tetra_kernel {

/// A plane across the end of a tree that truncates a field within a few radii of it.
struct EndCut {
    Vec3 center;   ///< [m] the end
    Vec3 outward;  ///< unit vector
    float radius;  ///< [m] at the end

    /// [radii] distance from its center up to which a cut acts; the line must end before it
    static constexpr float kReach = 3;
};

/// Truncates a sample of a field at p. The field of the plane decreases with the slope that value^(2/5) of
/// the quartic kernel has at the surface, so that distance estimates agree where the plane meets the bark.
COPPICE_HOST_DEVICE inline void cut_off(const EndCut& cut, float level, Vec3 p, FieldSample& s) {
    constexpr float kSlope = 1.6f;  // per radius
    const Vec3 w = p - cut.center;
    if (length_squared(w) > EndCut::kReach * EndCut::kReach * cut.radius * cut.radius) return;
    const float scale = kSlope / cut.radius;
    const float g = std::max(1 - scale * dot(w, cut.outward), 0.0f), root = std::sqrt(g);
    const float value = level * g * g * root;
    if (value < s.value) s = {value, -2.5f * level * scale * g * root * cut.outward};
}

}  // namespace coppice::tetra_kernel
