#pragma once

#include <algorithm>
#include <cstdint>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/vec.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/march/kernel/profile_kernel.h"

namespace coppice::tetra_kernel {

/// [fine edges] Maximum distance by which a held vertex is moved.
inline constexpr float kHeldReach = 0.45f;

/// Computes a Newton step along the gradient. Returns false if it is longer than `most`.
COPPICE_HOST_DEVICE inline bool step_to_surface(const Profile& profile, const FieldSample& s, float height,
                                                float most, Vec3& step) {
    const float slope = profile.slope(s.value);
    const Vec3 gradient = s.gradient * slope;
    const float squared = length_squared(gradient);
    if (!(height * height <= most * most * squared) || !(squared > 0) || most <= 0) return false;
    step = gradient * (-height / squared);
    return is_finite(step);
}

/// Target of a vertex, and its distance.
struct SnapPlace {
    Vec3 position;  ///< [m]
    float way;      ///< [m]
};

/// Computes a second step from the end of the first one and returns whether to move the vertex: the second
/// step must be the shorter one, and the total distance at most `reach`. `there` is the field at the end of
/// the first step.
COPPICE_HOST_DEVICE inline bool second_step(const Profile& profile, const FieldSample& there, Vec3 from,
                                            Vec3 first_end, float reach, SnapPlace& out) {
    const float first = distance(first_end, from);
    Vec3 step;
    const float height = profile.height(there.value);
    if (!step_to_surface(profile, there, height, std::max(0.5f * first, 0.02f * reach), step)) return false;
    out.position = first_end + step;
    out.way = distance(out.position, from);
    return out.way <= reach;
}

/// Target of a vertex that holds an axis.
struct AxisStep {
    Vec3 position;  ///< [m]
    float radius;   ///< [m] of the axis there
    float away;     ///< [m] distance from the axis before the move
};

/// Returns the point towards the closest point of the axis, at most `reach` away.
COPPICE_HOST_DEVICE inline AxisStep step_to_axis(const Segment& axis, Vec3 position, float reach) {
    const Vec3d a(axis.a), along = Vec3d(axis.b) - a, from(position);
    const double t = closest_parameter(from, a, along);
    const Vec3d way = a + along * t - from;
    const double whole = length(way);
    return {Vec3(from + way * (whole > reach ? reach / whole : 1)),
            axis.radius_a + static_cast<float>(t) * (axis.radius_b - axis.radius_a),
            static_cast<float>(whole)};
}

}  // namespace coppice::tetra_kernel
