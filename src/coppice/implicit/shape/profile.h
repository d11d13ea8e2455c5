#pragma once

#include <span>
#include <vector>

#include "coppice/implicit/polygonize/contour_index.h"
#include "coppice/implicit/shape/curve.h"

namespace coppice {

/// Planar line: closed contours that bound an area, or one open line. Spline contours are converted to
/// polygons with a deviation of at most 1e-4 of the profile's size.
class Profile {
  public:
    /// Creates one contour through the points. Throws InvalidInput for invalid curve points (see Curve), and
    /// for a closed contour without area.
    explicit Profile(std::span<const Vec2d> points, CurveKind kind = CurveKind::polyline, bool closed = true);

    /// Creates several closed contours: the area inside an odd number of them is inside, the area inside an
    /// even number is a hole.
    explicit Profile(std::span<const std::vector<Vec2d>> contours, CurveKind kind = CurveKind::polyline);

    bool closed() const { return closed_; }                                     ///< whether it bounds an area
    std::span<const std::vector<Vec2d>> contours() const { return contours_; }  ///< as polygons
    Vec2d low() const { return index_.low(); }                                  ///< minimum corner of its box
    Vec2d high() const { return index_.high(); }                                ///< maximum corner of its box
    double reach() const;  ///< [m] maximum distance from the origin of the plane

    /// [m] Returns the distance; negative inside a closed profile. The gradient has unit length; on the line
    /// it points outwards. Thread safe. Near the profile O(1) for most points, farther than its size O(log
    /// n).
    PlaneSample distance(Vec2d p) const { return index_.distance(p); }
    /// The same for many points.
    void distance(std::span<const Vec2d> points, std::span<PlaneSample> out) const;

  private:
    void add(std::span<const Vec2d> points, CurveKind kind);
    void finish();

    bool closed_;
    std::vector<std::vector<Vec2d>> contours_;
    ContourIndex index_;
};

/// Returns a regular polygon with `corners` corners on a circle; 64 or more look round.
std::vector<Vec2d> circle_contour(Vec2d center, double radius, int corners = 64);

}  // namespace coppice
