#pragma once

#include <cstddef>
#include <span>

namespace coppice::extract_internal {

/// A point on the plane with a weight.
struct PlanePoint {
    double x, y, weight;
};

struct CircleFit {
    bool good = false;  ///< enough points, far enough round, near enough to the circle
    double x = 0, y = 0, radius = 0;
    double residual = 0;   ///< root mean square distance of the points that count
    std::size_t used = 0;  ///< points that count
};

/// The circle nearest to points some of which do not belong to it: [Taubin1991] as a start, then distances
/// least squares with the weights of Tukey, from which points far from the circle drop out. Good also where
/// points cover one side of it only; where they cover less than about a third, it is not good. O(n).
CircleFit fit_circle(std::span<const PlanePoint> points, double greatest_radius);

}  // namespace coppice::extract_internal
