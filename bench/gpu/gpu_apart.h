#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

/// [m] How far a point of what a card makes may lie from where the CPU has it: a ten-thousandth of the radius
/// there, and what coordinates in single precision are off by after some sums.
float tolerance(Vec3 p, float radius);

/// The same of the points of a surface, by the radius of the branch at each.
std::vector<float> tolerances(std::span<const Vec3> points, const Skeleton& skeleton, const Context& ctx);

/// How many points of a lie farther from the point of b with the same number.
std::int64_t apart(std::span<const Vec3> a, std::span<const Vec3> b, std::span<const float> tolerance);

/// How many points of a lie farther from every point of b: where numbers differ. O(n log n) as points spread.
std::int64_t strays(std::span<const Vec3> a, std::span<const Vec3> b, std::span<const float> tolerance);

}  // namespace coppice::bench
