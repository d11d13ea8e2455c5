#pragma once

#include <span>

#include "coppice/extract/mesh/rings_internal.h"

namespace coppice::extract_internal {

/// Computes centre, radius and spread of a curve in space: of a closed curve about its centroid, projected
/// along its area normal; of an arc about its best-fitting circle. Requires at least two points.
Ring measure_ring(std::span<const Vec3d> points, bool closed);

}  // namespace coppice::extract_internal
