#pragma once

#include <cstddef>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice::points_internal {

/// Keeps `count` of the points, in their order, so that they lie as evenly as they can: the one that is
/// crowded most goes first, and so on. `radius` is half the distance at which points stop to matter to each
/// other, about half the distance of the most even set. Source: [Yuksel2015]. O(n log n). Throws InvalidInput
/// when points lie on one another so that this would take too long.
Buffer<Vec3> eliminate(const Buffer<Vec3>& points, std::size_t count, double radius, const Context& ctx);
double eliminate_bytes(double points);

}  // namespace coppice::points_internal
