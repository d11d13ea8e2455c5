#pragma once

#include <span>

#include "coppice/extract/mesh/rings_internal.h"

namespace coppice::extract_internal {

/// Center, radius and spread of a curve in space: of a closed one about its centroid, seen along its area
/// normal; of an arc about the circle that fits it best. At least two points.
Ring measure_ring(std::span<const Vec3d> points, bool closed);

}  // namespace coppice::extract_internal
