#pragma once

#include <span>
#include <vector>

#include "coppice/implicit/polygonize/contour_index.h"
#include "coppice/implicit/shape/curve.h"

namespace coppice {

/// A line in a plane: closed contours that bound an area, or one open line. Spline contours become polygons
/// that keep within 1e-4 of the profile's size.
class Profile {
  public:
    /// One contour through the points. Throws InvalidInput for points that do not make a curve (see Curve),
    /// and for a closed contour without area.
    explicit Profile(std::span<const Vec2d> points, CurveKind kind = CurveKind::polyline, bool closed = true);

    /// Several closed contours: an area within an even number of them is a hole, within an odd number inside.
    explicit Profile(std::span<const std::vector<Vec2d>> contours, CurveKind kind = CurveKind::polyline);

    bool closed() const { return closed_; }                                     ///< whether it bounds an area
    std::span<const std::vector<Vec2d>> contours() const { return contours_; }  ///< as polygons
    Vec2d low() const { return index_.low(); }                                  ///< of the box around it
    Vec2d high() const { return index_.high(); }                                ///< and its greatest corner
    double reach() const;  ///< [m] greatest distance from the origin of the plane

    /// [m] Negative inside a closed profile. The gradient has unit length; on the line it points outward.
    /// Thread safe. Near the profile O(1) for most points, farther than its size O(log n).
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

/// The polygon of n corners on a circle; n >= 64 looks round.
std::vector<Vec2d> circle_contour(Vec2d center, double radius, int corners = 64);

}  // namespace coppice
