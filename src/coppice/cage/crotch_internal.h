#pragma once

#include "coppice/base/vec.h"

namespace coppice::cage_internal {

/// The point where two round cylinders that leave one point part.
struct Crotch {
    float distance;          ///< [m] from where they begin
    float angle_a, angle_b;  ///< [radians] of the way there from each axis
};

/// Of cylinders with these unit directions and radii in metres.
Crotch crotch(Vec3 a, float radius_a, Vec3 b, float radius_b);

}  // namespace coppice::cage_internal
