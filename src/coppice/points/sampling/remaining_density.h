#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/points/point_region.h"
#include "coppice/points/point_set.h"
#include "coppice/points/sampling/radial_kernel.h"

namespace coppice {

/// What points leave of a density, at each place: that of the region times the kernel at the distance of each
/// point. It is what Lane's method draws the next point from [Lane2002]; `sample_lane` takes the soft part of
/// a kernel for constant in a cell, here it is exact. The factors together are `greatest_factor` at most.
/// Places [m] as the region's box. O(places), times the points within the kernel's reach. Throws Cancelled.
std::vector<double> remaining_density(const PointRegion& region, const RadialKernel& kernel,
                                      const PointSet& points, std::span<const Vec3> places,
                                      double greatest_factor = 100, const Context& ctx = {});

}  // namespace coppice
