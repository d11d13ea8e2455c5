#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/spatial/box_tree.h"

namespace coppice {

/// A point or direction in a plane [m].
struct Vec2d {
    double x = 0;  ///< along the first axis
    double y = 0;  ///< along the second axis

    /// Component-wise.
    friend constexpr Vec2d operator+(Vec2d a, Vec2d b) { return {a.x + b.x, a.y + b.y}; }
    /// Component-wise.
    friend constexpr Vec2d operator-(Vec2d a, Vec2d b) { return {a.x - b.x, a.y - b.y}; }
    /// Component-wise.
    friend constexpr Vec2d operator*(Vec2d a, double s) { return {a.x * s, a.y * s}; }
    /// Component-wise.
    friend constexpr bool operator==(Vec2d, Vec2d) = default;
};

/// Distance to a profile and its gradient, at a point of the profile's plane.
struct PlaneSample {
    double value = 0;  ///< [m] negative inside
    Vec2d gradient;    ///< points away from the profile
};

/// A line segment in a plane.
struct PlaneSegment {
    Vec2d a;  ///< start
    Vec2d b;  ///< end
};

/// [m^2] Returns the area of the polygon; positive if it is counter-clockwise.
double contour_area(std::span<const Vec2d> corners);

inline constexpr double kMinContourArea = 1e-9;  ///< [size squared] minimum area of a valid contour

/// Finds the nearest of many segments in a plane, and determines whether a point is inside the contours that
/// they form: a ray from the point to infinity intersects them an odd number of times.
///
/// A quadtree around the segments lists the segments that can be nearest in each square; lists are short
/// except where many segments are equally far. O(n log n) construction; memory O(n).
class ContourIndex {
  public:
    ContourIndex() : boxes_({}, Context{.threads = 1}) {}

    /// There must be at least one segment, and all must have a length; contours must be closed if `closed`,
    /// which makes the distance signed.
    ContourIndex(std::vector<PlaneSegment> segments, bool closed);

    Vec2d low() const { return low_; }    ///< minimum corner of the box of all segments
    Vec2d high() const { return high_; }  ///< maximum corner

    /// Returns the distance; infinite for NaN.
    PlaneSample distance(Vec2d p) const;
    bool inside(Vec2d p) const;  ///< Returns whether p is inside an odd number of contours.

  private:
    enum class Side : std::uint8_t { unknown, inside, outside };
    struct Cell {
        std::uint32_t first = 0;  ///< first index of its list, or of its four children
        std::uint32_t count = 0;
        bool is_leaf = false;
        bool is_complete = false;  ///< otherwise the list only contains the segment nearest to the centre
        Side side = Side::unknown;
    };

    void build_cells();
    void build_rows();
    std::uint32_t row(double y) const;
    const Cell* find(Vec2d p) const;
    PlaneSample signed_sample(Vec2d p, std::uint32_t segment, double squared, Side side) const;

    std::vector<PlaneSegment> segments_;
    bool closed_ = false;
    Vec2d low_, high_, center_;
    double half_ = 0;  ///< [m] of the outermost square
    std::vector<Cell> cells_;
    std::vector<std::uint32_t> list_;
    double rows_per_metre_ = 0;
    std::vector<std::uint32_t> row_first_, row_list_;  ///< segments by stripes of y, for `inside`
    BoxTree boxes_;                                    ///< for points outside the squares
};

}  // namespace coppice
