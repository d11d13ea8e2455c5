#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice {

/// Ground under trees, as a raster of heights. Beyond its boundary the height is that of the closest point on
/// it.
class Terrain {
  public:
    Terrain() = default;  ///< flat, at height 0
    /// Creates a raster of heights [m], stored by rows of `columns` values, the first at (x0, y0) [m], at a
    /// distance of `cell` > 0 [m]; all are finite.
    Terrain(double x0, double y0, double cell, std::size_t columns, std::vector<double> heights)
        : x0_(x0), y0_(y0), cell_(cell), columns_(columns), heights_(std::move(heights)) {}

    /// Returns the height [m] of the ground at a position by bilinear interpolation.
    double height(double x, double y) const {
        if (heights_.empty()) return 0;
        const std::size_t rows = heights_.size() / columns_;
        const double u = std::clamp((x - x0_) / cell_, 0.0, static_cast<double>(columns_ - 1));
        const double v = std::clamp((y - y0_) / cell_, 0.0, static_cast<double>(rows - 1));
        const auto i = std::min(static_cast<std::size_t>(u), columns_ - 1),
                   i1 = std::min(i + 1, columns_ - 1);
        const auto j = std::min(static_cast<std::size_t>(v), rows - 1), j1 = std::min(j + 1, rows - 1);
        const double s = u - static_cast<double>(i), t = v - static_cast<double>(j);
        const auto at = [&](std::size_t column, std::size_t row) {
            return heights_[row * columns_ + column];
        };
        return std::lerp(std::lerp(at(i, j), at(i1, j), s), std::lerp(at(i, j1), at(i1, j1), s), t);
    }

    bool is_ground = false;  ///< whether there are ground points; otherwise a plane below nearly all points
    double share = 0;        ///< share of the non-empty cells with their lowest point on the ground
    double clearance = 0;    ///< [m] thickness above it of the points that belong to the ground

  private:
    double x0_ = 0, y0_ = 0, cell_ = 1;
    std::size_t columns_ = 0;
    std::vector<double> heights_;
};

/// Computes the ground of a cloud, including slopes and hummocks.
///
/// A plane is fitted below the lowest points and corrected in rasters of decreasing cells, down to half a
/// metre or 1/500 of the extent. A cell is the weighted mean of the height of its lowest points and of its
/// neighbours; points above the surface have little weight, so that a cell full of branches gets the height
/// of the surrounding ground, and an outlier below it has little influence. The surface is ground if half of
/// the non-empty cells have their lowest point on it and the cloud rises above it. Otherwise it is a plane
/// above a hundredth of the cells' lowest points, near the bases of trees. O(n). Throws Cancelled.
Terrain find_terrain(std::span<const Vec3> points, const Context& ctx = {});

}  // namespace coppice
