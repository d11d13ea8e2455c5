#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/spatial/box_tree.h"

namespace coppice {

/// A point or direction in a plane [m].
struct Vec2d {
    double x = 0;  ///< along the first axis
    double y = 0;  ///< along the second

    /// Coordinate by coordinate.
    friend constexpr Vec2d operator+(Vec2d a, Vec2d b) { return {a.x + b.x, a.y + b.y}; }
    /// Coordinate by coordinate.
    friend constexpr Vec2d operator-(Vec2d a, Vec2d b) { return {a.x - b.x, a.y - b.y}; }
    /// Coordinate by coordinate.
    friend constexpr Vec2d operator*(Vec2d a, double s) { return {a.x * s, a.y * s}; }
    /// Coordinate by coordinate.
    friend constexpr bool operator==(Vec2d, Vec2d) = default;
};

/// Distance to a profile and its gradient, at a point of the profile's plane.
struct PlaneSample {
    double value = 0;  ///< [m] negative inside
    Vec2d gradient;    ///< away from the profile
};

/// A line between two points in a plane.
struct PlaneSegment {
    Vec2d a;  ///< one end
    Vec2d b;  ///< the other
};

/// [m^2] Of the polygon; positive when it turns counterclockwise.
double contour_area(std::span<const Vec2d> corners);

inline constexpr double kLeastContourArea = 1e-9;  ///< [size squared] less is no area

/// Finds the nearest of many segments in a plane, and whether a point is inside the contours that they make:
/// the line from there to infinity crosses them an odd number of times.
///
/// Squares around the segments, cut in four again and again, list what can be nearest in them; lists are
/// short but close to where many segments are equally far. O(n log n) to make; memory O(n).
class ContourIndex {
  public:
    ContourIndex() : boxes_({}, Context{.threads = 1}) {}

    /// There must be a segment, and all must have a length; contours must be closed if `closed`, which makes
    /// the distance signed.
    ContourIndex(std::vector<PlaneSegment> segments, bool closed);

    Vec2d low() const { return low_; }    ///< least corner of the box about all segments
    Vec2d high() const { return high_; }  ///< greatest corner

    /// Infinite for a point that is not a number.
    PlaneSample distance(Vec2d p) const;
    bool inside(Vec2d p) const;  ///< Whether p lies within an odd number of contours.

  private:
    enum class Side : std::uint8_t { unknown, inside, outside };
    struct Cell {
        std::uint32_t first = 0;  ///< of its list, or of its four children
        std::uint32_t count = 0;
        bool is_leaf = false;
        bool is_complete = false;  ///< else the list is just the segment nearest to the centre
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
    BoxTree boxes_;                                    ///< for points beyond the squares
};

}  // namespace coppice
