#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice {

/// The ground under trees, as a raster of heights. Beyond its rim the nearest height on it holds.
class Terrain {
  public:
    Terrain() = default;  ///< flat, at height 0
    /// Heights [m] row by row, `columns` in each, the first at (x0, y0) [m], `cell` > 0 [m] apart; all
    /// finite.
    Terrain(double x0, double y0, double cell, std::size_t columns, std::vector<double> heights)
        : x0_(x0), y0_(y0), cell_(cell), columns_(columns), heights_(std::move(heights)) {}

    /// [m] of the ground below or above a place: bilinear between the heights around it.
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

    bool is_ground = false;  ///< there are points of ground; else it is a plane below nearly all points
    double share = 0;        ///< of the cells with points whose lowest point lies on it
    double clearance = 0;    ///< [m] above it, up to which points belong to the ground

  private:
    double x0_ = 0, y0_ = 0, cell_ = 1;
    std::size_t columns_ = 0;
    std::vector<double> heights_;
};

/// The ground of a cloud, on slopes and hummocks too.
///
/// A plane is laid below the lowest points, and bent in rasters of ever smaller cells, down to half a metre
/// or 1/500 of the extent, each a correction to the one before it. A cell takes part with what its lowest
/// points say and is tied to its neighbours; what stands above the surface hardly counts, so that a cell
/// full of branches takes the height of the ground around it, and a stray point below it counts little.
/// It is ground where half of the cells with points have their lowest point on it, and the cloud rises
/// above it. Else it is a plane that a hundredth of the cells' lowest points lie below, near the feet of
/// trees. O(n). Throws Cancelled.
Terrain find_terrain(std::span<const Vec3> points, const Context& ctx = {});

}  // namespace coppice
