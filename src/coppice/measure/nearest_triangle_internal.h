#pragma once

#include <cmath>
#include <limits>

#include "coppice/measure/surface_tree.h"

namespace coppice::measure_internal {

/// Finds the triangle that is nearest to a point, of those that are added, and on which side of it the point
/// is. Of several that are equally near, at an edge or a corner, the one that the point lies most squarely
/// before decides.
class NearestTriangle {
  public:
    explicit NearestTriangle(Vec3d p) : p_(p) {}

    /// Degenerate triangles are left out.
    void add(Vec3d a, Vec3d b, Vec3d c) {
        // Faces around one edge come out equally far but for rounding.
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

    /// [m^2] Nothing farther than the root of this is wanted any more.
    const double& limit_squared() const { return limit_; }
    /// [m] to the nearest triangle, negative behind it; infinite without triangles.
    double signed_distance() const { return std::copysign(std::sqrt(least_), before_); }

  private:
    Vec3d p_;
    double least_ = std::numeric_limits<double>::infinity(), limit_ = least_, before_ = 0;
};

}  // namespace coppice::measure_internal
