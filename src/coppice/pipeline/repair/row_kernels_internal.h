#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/base/vec.h"

namespace coppice::pipeline_internal {

/// Points in rows, one array per coordinate; quad k of row j has the corners (j, k), (j, k + 1), (j + 1, k +
/// 1), (j + 1, k).
struct RowPoints {
    static constexpr std::size_t kMin = 8;  ///< minimum capacity
    std::size_t rows = 0;                   ///< number of rows of quads; points have one more
    std::size_t columns = 0;                ///< number of columns of quads; points have one more
    std::vector<double> x, y, z;

    std::size_t stride() const { return columns + 1; }  ///< offset from a point to that in the next row
    std::size_t size() const { return (rows + 1) * stride(); }  ///< number of points
    /// Sets the number of rows and columns.
    void resize(std::size_t row_count, std::size_t column_count) {
        rows = row_count;
        columns = column_count;
        for (auto* c : {&x, &y, &z}) c->resize(std::max(size(), kMin));
    }
    /// Fills up with the first point if there are fewer than a vector contains.
    void pad() {
        for (auto* c : {&x, &y, &z})
            std::fill(c->begin() + static_cast<std::ptrdiff_t>(size()), c->end(), c->front());
    }
    /// Sets the point of a row and column.
    void set(std::size_t row, std::size_t column, Vec3 p) {
        const std::size_t i = row * stride() + column;
        x[i] = static_cast<double>(p.x);
        y[i] = static_cast<double>(p.y);
        z[i] = static_cast<double>(p.z);
    }
};

/// Directions, one array per coordinate.
struct Directions {
    static constexpr std::size_t kCount = 8;  ///< number of directions
    std::array<double, kCount> x{}, y{}, z{};
    /// Sets direction i.
    void set(std::size_t i, Vec3d d) {
        x[i] = d.x;
        y[i] = d.y;
        z[i] = d.z;
    }
};

/// Extent of points along directions; initially empty.
struct Reach {
    std::array<double, Directions::kCount> low = filled(std::numeric_limits<double>::infinity());
    std::array<double, Directions::kCount> high = filled(-std::numeric_limits<double>::infinity());

    /// Extends it by another extent.
    void extend(const Reach& by) {
        for (std::size_t i = 0; i < Directions::kCount; ++i) {
            low[i] = std::min(low[i], by.low[i]);
            high[i] = std::max(high[i], by.high[i]);
        }
    }

  private:
    static std::array<double, Directions::kCount> filled(double x) {
        std::array<double, Directions::kCount> a;
        a.fill(x);
        return a;
    }
};

/// Minimum distance between two extents, per direction, at which they are certainly disjoint.
using Margins = std::array<double, Directions::kCount>;

/// Returns whether two extents are disjoint along one of the directions.
inline bool is_apart(const Reach& a, const Reach& b, const Margins& margin) {
    for (std::size_t i = 0; i < Directions::kCount; ++i) {
        if (a.low[i] > b.high[i] + margin[i] || b.low[i] > a.high[i] + margin[i]) return true;
    }
    return false;
}

/// Sets bad[j] to whether a quad of row j does not face away from c: whether the volume over c of one of the
/// four triangles of its corners is not above `margin`. Vector code.
void mark_rows_that_turn(const RowPoints& points, Vec3d c, double margin, std::int32_t* bad);

/// Extends an extent by some of the points. Vector code.
void extend_reach(const RowPoints& points, IndexRange range, const Directions& directions, Reach& reach);

/// Bounds of points: a box, and the distance from a segment.
struct Bounds {
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec3d low{kInfinity, kInfinity, kInfinity};
    Vec3d high{-kInfinity, -kInfinity, -kInfinity};
    double distance_squared = 0;  ///< [m^2] maximum from the segment
};

/// Extends bounds by all points, with the segment from a along the unit direction d. Vector code.
void extend_bounds(const RowPoints& points, Vec3d a, Vec3d d, double length, Bounds& bounds);

/// Orthogonal unit vectors.
struct RingFrame {
    Vec3d u, v, axis;
};

/// Properties of a ring of a row as it runs around an axis through c.
struct RingTurn {
    double min_area;         ///< [m^2] minimum of twice the areas that its steps sweep, seen along the axis
    double turns;            ///< number of times it passes from v < 0 to v >= 0
    double tangent_squared;  ///< of the maximum enclosed angle from the axis; 0 if part of it is behind c
};

/// `row` may be the one after the last. The number of columns must be a multiple of four. Vector code.
RingTurn turn_of_ring(const RowPoints& points, std::size_t row, Vec3d c, const RingFrame& frame);

}  // namespace coppice::pipeline_internal
