#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "coppice/points/point_region.h"
#include "coppice/points/point_set.h"
#include "errors.h"

namespace coppice::points_support {

using test::error_of;

/// Ball of radius 1: the value decreases from 2 at the centre to 0 at distance 2, and is 1 at the surface.
struct Ball {
    Vec3 center{};
    float level() const { return 1; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec3 d = points[i] - center;
            const float r = length(d);
            out[i] = {std::max(0.0f, 2 - r), r < 2 ? -normalized(d) : Vec3{}};
        }
    }
};

/// Field with the x coordinate as value.
struct Ramp {
    float level() const { return 0; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) out[i] = {points[i].x, {1, 0, 0}};
    }
};

inline Box3 ball_box() { return {{-2, -2, -2}, {2, 2, 2}}; }

inline double min_distance(const PointSet& set) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < set.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            least = std::min(least, distance(Vec3d(set.positions[i]), Vec3d(set.positions[k])));
        }
    }
    return least;
}

/// Returns Pearson's chi-squared statistic; expected counts are at least 5.
inline double chi_square(std::span<const double> seen, std::span<const double> expected) {
    double sum = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        sum += (seen[i] - expected[i]) * (seen[i] - expected[i]) / expected[i];
    }
    return sum;
}

}  // namespace coppice::points_support
