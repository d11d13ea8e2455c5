#pragma once

#include <algorithm>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"

namespace coppice {

/// Returns the parameter in [0, 1] of the point of the segment from a to a + d that is closest to p; `none`
/// if d is 0.
template <class T>
COPPICE_HOST_DEVICE T closest_parameter(BasicVec3<T> p, BasicVec3<T> a, BasicVec3<T> d, T none = 0) {
    const T squared = length_squared(d);
    return squared > 0 ? std::clamp(dot(p - a, d) / squared, T{0}, T{1}) : none;
}

/// Parameters in [0, 1] of the closest points of the segments a0 a1 and b0 b1; segments of zero length are
/// allowed. Source: [Ericson2005] 5.1.9.
struct ClosestParameters {
    double on_a;  ///< 0 at a0, 1 at a1
    double on_b;  ///< 0 at b0, 1 at b1
};

/// See ClosestParameters.
inline ClosestParameters closest_parameters(Vec3d a0, Vec3d a1, Vec3d b0, Vec3d b1) {
    const Vec3d da = a1 - a0, db = b1 - b0, r = a0 - b0;
    const double aa = dot(da, da), bb = dot(db, db), ab = dot(da, db), ar = dot(da, r), br = dot(db, r);
    const auto ratio = [](double x, double y) { return y > 0 ? std::clamp(x / y, 0.0, 1.0) : 0.0; };
    double s = ratio(ab * br - ar * bb, aa * bb - ab * ab);
    const double t = bb > 0 ? (ab * s + br) / bb : 0.0;
    if (t < 0 || bb <= 0) {
        s = ratio(-ar, aa);
    } else if (t > 1) {
        s = ratio(ab - ar, aa);
    }
    return {s, std::clamp(t, 0.0, 1.0)};
}

/// [m] Returns the distance between the segments a0 a1 and b0 b1.
inline double segment_distance(Vec3d a0, Vec3d a1, Vec3d b0, Vec3d b1) {
    const ClosestParameters c = closest_parameters(a0, a1, b0, b1);
    return distance(lerp(a0, a1, c.on_a), lerp(b0, b1, c.on_b));
}

}  // namespace coppice
