#pragma once

#include <cstddef>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice::points_internal {

/// Keeps the `count` points, in their order, that are distributed most evenly: repeatedly removes the point
/// with the largest weight of its neighbours. `radius` is half the maximum distance of neighbours, about half
/// the distance of the most even set. Source: [Yuksel2015]. O(n log n). Throws InvalidInput if so many points
/// coincide that this would take too long.
Buffer<Vec3> eliminate(const Buffer<Vec3>& points, std::size_t count, double radius, const Context& ctx);
double eliminate_bytes(double points);

}  // namespace coppice::points_internal
