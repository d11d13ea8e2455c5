#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/implicit/shape/shape.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {

/// Interpolation of a curve between its points; it passes through all of them.
enum class CurveKind {
    polyline,     ///< straight
    catmull_rom,  ///< tangents from the neighbours, centripetal: local, no loops or cusps [Yuksel2011]
    natural       ///< cubic spline with continuous curvature, which is zero at open ends
};

template <>
struct EnumNames<CurveKind> {
    static constexpr std::array<std::string_view, 3> names{"polyline", "catmull_rom", "natural"};
};

/// Options of Curve.
struct CurveOptions {
    CurveKind kind = CurveKind::catmull_rom;  ///< straight or smooth
    bool closed = false;                      ///< an additional section connects the last point to the first
};

/// Lists the members for front ends.
void list_fields(CurveOptions& o, FieldList& list);

/// A cubic c0 + t (c1 + t (c2 + t c3)), 0 <= t <= 1, with a curvature so small that it is within `slack` of
/// its chord.
struct CurveArc {
    std::array<Vec3d, 4> c;  ///< [m] coefficients
    double slack = 0;        ///< [m]
    double start = 0;        ///< [m] length of the curve before it
    double length = 0;       ///< [m]

    Vec3d position(double t) const { return c[0] + (c[1] + (c[2] + c[3] * t) * t) * t; }  ///< [m] at t
    /// Returns the first derivative by t.
    Vec3d first(double t) const { return c[1] + (c[2] * 2.0 + c[3] * (3.0 * t)) * t; }
    Vec3d second(double t) const { return c[2] * 2.0 + c[3] * (6.0 * t); }  ///< second derivative by t
    Vec3d tangent(double t) const { return normalized(first(t)); }          ///< of unit length
};

/// Right-handed frame: tangent = normal x binormal, all of unit length.
struct CurveFrame {
    Vec3d position;  ///< [m] on the curve
    Vec3d tangent;   ///< forward
    Vec3d normal;    ///< x direction of transported profiles
    Vec3d binormal;  ///< y direction of transported profiles
};

/// A point on a curve: an arc and its parameter.
struct CurvePlace {
    std::uint32_t arc = 0;  ///< index into Curve::arcs()
    double t = 0;           ///< in [0, 1]
};

/// A curve through points in space; a planar one has z = 0. Its length is accurate to about 1e-9, and the
/// global nearest point is found, not just a local one. O(n) construction; about 300 bytes per point, more in
/// tight bends.
class Curve {
  public:
    /// Throws InvalidInput for fewer than 2 points (3 if closed) or more than a million, consecutive points
    /// that coincide, or a point that is NaN or beyond 1e9 m.
    explicit Curve(std::span<const Vec3> points, const CurveOptions& options = {});

    bool closed() const { return closed_; }  ///< whether an additional section connects the ends
    /// Returns the number of sections between points.
    std::uint32_t span_count() const { return static_cast<std::uint32_t>(first_arc_.size()) - 1; }
    double length() const { return length_; }  ///< [m]
    Box3 bounds() const { return bounds_; }    ///< [m] box of the curve

    /// Returns the place at a `fraction` of the length, clamped to [0, 1].
    CurvePlace at_fraction(double fraction) const;
    /// Returns the place at a parameter: i is point i; other parameters are interpolated evenly in the
    /// section. Clamped to [0, span_count].
    CurvePlace at_index(double index) const;
    double fraction(CurvePlace place) const;  ///< share of the length before a place

    /// [m] Returns the position of a place.
    Vec3d position(CurvePlace place) const { return arcs_[place.arc].position(place.t); }

    /// Returns a rotation-minimizing frame [Wang2008]. At the start, normal and binormal are the world's x
    /// and y, rotated by the smallest rotation that maps z to the tangent. On a closed curve the remaining
    /// angle at the end is distributed evenly over the length, so that the frames match.
    CurveFrame frame(CurvePlace place) const;
    double closing_roll() const { return closing_roll_; }  ///< [rad] the distributed angle; 0 if open

    /// Returns the nearest point of the curve. O(log n) near the curve. `hint` is a place that may be near;
    /// it affects the time, not the result.
    CurvePlace closest(Vec3d p, CurvePlace hint = {}) const;

    std::span<const CurveArc> arcs() const { return arcs_; }  ///< in order
    const BoxTree& boxes() const { return boxes_; }           ///< of the arcs

  private:
    void cut(std::span<const std::array<Vec3d, 4>> cubics);
    void measure();
    void carry_frames();

    bool closed_ = false;
    std::vector<CurveArc> arcs_;
    std::vector<std::uint32_t> first_arc_;  ///< by section, and one more
    std::vector<Vec3d> normals_;            ///< at the start of each arc, before the closing roll
    double length_ = 0;
    double closing_roll_ = 0;
    Box3 bounds_;
    BoxTree boxes_;
};

/// The curve itself as a shape: the distance is not signed. On the curve the gradient is an arbitrary unit
/// vector perpendicular to it.
class CurveShape final : public Shape {
  public:
    explicit CurveShape(Curve curve) : curve_(std::move(curve)) {}  ///< moves the curve into the shape
    Box3 bounds() const override { return curve_.bounds(); }
    void distance(std::span<const Vec3> points, std::span<FieldSample> out) const override;
    bool is_closed() const override { return false; }
    const Curve& curve() const { return curve_; }  ///< the curve

  private:
    Curve curve_;
};

}  // namespace coppice
