#pragma once

#include "coppice/base/vec.h"
#include "coppice/implicit/shape/curve.h"

namespace coppice {

/// Returns the parameter at which the plane perpendicular to the arc contains p, and the distance has a local
/// minimum: 0 < t < 1, or -1 if the slopes at its ends, half the derivatives of the squared distance, show
/// that there is no such parameter.
double local_closest_parameter(const CurveArc& arc, Vec3d p, double slope_at_start, double slope_at_end);

inline double distance_slope(const CurveArc& arc, Vec3d p, double t) {
    return dot(arc.position(t) - p, arc.first(t));
}

}  // namespace coppice
