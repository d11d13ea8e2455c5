#pragma once

#include "coppice/base/vec.h"
#include "coppice/implicit/shape/curve.h"

namespace coppice {

/// Where the plane across the arc holds p, and the arc draws away from p on both sides: 0 < t < 1, or -1 when
/// the slopes at its ends, half the derivatives of the squared distance, say that there is no such place.
double local_foot(const CurveArc& arc, Vec3d p, double slope_at_start, double slope_at_end);

inline double distance_slope(const CurveArc& arc, Vec3d p, double t) {
    return dot(arc.position(t) - p, arc.first(t));
}

}  // namespace coppice
