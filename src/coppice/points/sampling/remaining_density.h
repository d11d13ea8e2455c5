#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/points/point_region.h"
#include "coppice/points/point_set.h"
#include "coppice/points/sampling/radial_kernel.h"

namespace coppice {

/// Returns the remaining density at each position: that of the region times the kernels of all points. Lane's
/// method draws the next point from it [Lane2002]; `sample_dart_throwing` approximates the soft part of a
/// kernel as constant in a cell, here it is exact. The product of the kernels is at most `max_factor`.
/// Positions [m] are in the coordinate frame of the region's box. O(places), times the number of points
/// within the reach of the kernel. Throws Cancelled.
std::vector<double> remaining_density(const PointRegion& region, const RadialKernel& kernel,
                                      const PointSet& points, std::span<const Vec3> places,
                                      double max_factor = 100, const Context& ctx = {});

}  // namespace coppice
