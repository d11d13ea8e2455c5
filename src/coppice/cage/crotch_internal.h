#pragma once

#include "coppice/base/vec.h"

namespace coppice::cage_internal {

/// The point at which two round cylinders with a common beginning separate.
struct Crotch {
    float distance;          ///< [m] from their beginning
    float angle_a, angle_b;  ///< [rad] between the direction to the point and each axis
};

/// Returns the crotch of cylinders with these unit directions and radii in metres.
Crotch crotch(Vec3 a, float radius_a, Vec3 b, float radius_b);

}  // namespace coppice::cage_internal
