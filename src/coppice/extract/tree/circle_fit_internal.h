#pragma once

#include <cstddef>
#include <span>

namespace coppice::extract_internal {

/// Weighted point on the plane.
struct PlanePoint {
    double x, y, weight;
};

struct CircleFit {
    bool good = false;  ///< whether there are enough points, in enough sectors, close enough to the circle
    double x = 0, y = 0, radius = 0;
    double residual = 0;   ///< root mean square distance of the used points
    std::size_t used = 0;  ///< number of used points
};

/// Fits a circle to points with outliers: [Taubin1991] as the initial value, then least squares of distances
/// with Tukey's weights, which ignore points far from the circle. The result is also good if points cover
/// only one side of the circle; it is not good if they cover less than about a third. O(n).
CircleFit fit_circle(std::span<const PlanePoint> points, double max_radius);

}  // namespace coppice::extract_internal
