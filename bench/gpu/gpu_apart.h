#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

/// [m] Returns the accepted distance between a point computed on the GPU and on the CPU: a ten-thousandth of
/// the radius there, plus the rounding of sums of coordinates in single precision.
float tolerance(Vec3 p, float radius);

/// Returns the tolerances of the points of a surface, using the radius of the branch at each.
std::vector<float> tolerances(std::span<const Vec3> points, const Skeleton& skeleton, const Context& ctx);

/// Returns the number of points of a that are farther than the tolerance from the point of b with the same
/// number.
std::int64_t apart(std::span<const Vec3> a, std::span<const Vec3> b, std::span<const float> tolerance);

/// Returns the number of points of a that are farther than the tolerance from every point of b, for surfaces
/// with different numbering. O(n log n) for well distributed points.
std::int64_t strays(std::span<const Vec3> a, std::span<const Vec3> b, std::span<const float> tolerance);

}  // namespace coppice::bench
