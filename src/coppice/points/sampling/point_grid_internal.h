#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice::points_internal {

/// Fixed set of points in cubic cells, sorted by cell, so that points close in space are close in memory. A
/// place is the index of a point in that order. Distances are exact: those of the float positions in double
/// precision.
class PointGrid {
  public:
    /// `edge` [m] is the edge of the cells, above 0; queries with a smaller radius visit 27 cells. Requires
    /// finite points, fewer than 2^32 - 1. O(n). Throws Cancelled.
    PointGrid(std::span<const Vec3> points, double edge, const Context& ctx);
    static double bytes(double count);  ///< maximum memory for a number of points

    std::uint32_t size() const { return static_cast<std::uint32_t>(points_.size()); }
    Vec3 operator[](std::uint32_t place) const { return points_[place]; }
    std::uint32_t number(std::uint32_t place) const {
        return number_[place];
    }  ///< index of the point in the input

    /// Calls visit(place, squared distance) for the points within `radius`: cells sorted by z, y and x, the
    /// last point of a cell first. A visit that returns false ends the search; the function then returns
    /// false.
    template <class Visit>
    bool visit(Vec3 p, double radius, const Visit& visit) const {
        const double radius2 = radius * radius;
        const Cell low = cell(p, -radius), high = cell(p, radius);
        for (std::uint32_t z = low[2]; z <= high[2]; ++z) {
            for (std::uint32_t y = low[1]; y <= high[1]; ++y) {
                const auto [first, end] = in_row(row(y, z), low[0], high[0]);
                for (std::uint32_t i = first; i < end; ++i) {
                    const double d2 = length_squared(Vec3d(points_[i]) - Vec3d(p));
                    if (d2 <= radius2 && !visit(i, d2)) return false;
                }
            }
        }
        return true;
    }

  private:
    using Cell = std::array<std::uint32_t, 3>;
    /// maximum number of cells along an axis: 63 bits store all three
    static constexpr std::uint32_t kMax = (1u << 21) - 1;
    static constexpr std::uint64_t kFree = ~std::uint64_t{0};
    /// Places of the points in the cells of one y and z.
    struct Row {
        std::uint64_t key = kFree;
        std::uint32_t first = 0, end = 0;
    };

    std::int64_t whole(float x, double by) const {
        const double scaled = (x + by) * per_cell_;
        const auto down = static_cast<std::int64_t>(scaled);
        return down - (static_cast<double>(down) > scaled ? 1 : 0);
    }
    /// Returns the cell of x + by along an axis; the outermost cells include everything beyond.
    std::uint32_t along(std::size_t axis, float x, double by) const {
        return static_cast<std::uint32_t>(
            std::clamp<std::int64_t>(whole(x, by) - low_[axis], 0, last_[axis]));
    }
    Cell cell(Vec3 p, double by) const { return {along(0, p.x, by), along(1, p.y, by), along(2, p.z, by)}; }
    std::uint64_t row(std::uint32_t y, std::uint32_t z) const { return std::uint64_t{z} << y_bits_ | y; }
    std::size_t find_slot(std::uint64_t row) const;
    /// Returns the places in the cells from x0 to x1 of a row, [first, end).
    std::array<std::uint32_t, 2> in_row(std::uint64_t row, std::uint32_t x0, std::uint32_t x1) const;
    void sort(std::span<const Vec3> points, const Context& ctx);
    void index_rows();

    double per_cell_;
    std::array<std::int64_t, 3> low_{};  ///< first cell along each axis, in edges from the origin
    Cell last_{kMax, kMax, kMax};        ///< last cell along each axis
    unsigned x_bits_ = 0, y_bits_ = 0, z_bits_ = 0;
    Buffer<Vec3> points_;
    Buffer<std::uint32_t> number_;
    Buffer<Row> rows_;  ///< hash table; its size is a power of two
};

}  // namespace coppice::points_internal
