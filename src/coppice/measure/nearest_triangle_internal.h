#pragma once

#include <cmath>
#include <limits>

#include "coppice/measure/surface_tree.h"

namespace coppice::measure_internal {

/// Finds the nearest of the added triangles to a point, and the side of it on which the point is. If several
/// are equally near, at an edge or a corner, the one with the largest distance from its plane to the point
/// decides.
class NearestTriangle {
  public:
    explicit NearestTriangle(Vec3d p) : p_(p) {}

    /// Degenerate triangles are ignored.
    void add(Vec3d a, Vec3d b, Vec3d c) {
        // The distances to the faces at one edge are equal except for rounding.
        constexpr double kMore = 1 + 1e-9, kLess = 1 - 1e-9;
        const double d2 = distance_squared(p_, a, b, c);
        if (!(d2 <= limit_)) return;
        const Vec3d normal = cross(b - a, c - a);
        const double size = length(normal);
        if (!(size > 0)) return;
        const double to_plane = dot(p_ - a, normal) / size;
        if (d2 < least_ * kLess || std::fabs(to_plane) > std::fabs(before_)) before_ = to_plane;
        least_ = std::min(least_, d2);
        limit_ = least_ * kMore;
    }

    /// [m^2] Returns the squared distance beyond which triangles are irrelevant.
    const double& limit_squared() const { return limit_; }
    /// [m] Returns the distance to the nearest triangle, negative behind it; infinite without triangles.
    double signed_distance() const { return std::copysign(std::sqrt(least_), before_); }

  private:
    Vec3d p_;
    double least_ = std::numeric_limits<double>::infinity(), limit_ = least_, before_ = 0;
};

}  // namespace coppice::measure_internal
