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

/// How a curve runs from point to point; it passes through all of them.
enum class CurveKind {
    polyline,     ///< straight
    catmull_rom,  ///< tangents from the neighbours, centripetal: local, no loops or cusps [Yuksel2011]
    natural       ///< the cubic spline whose curvature is continuous, and zero at open ends
};

template <>
struct EnumNames<CurveKind> {
    static constexpr std::array<std::string_view, 3> names{"polyline", "catmull_rom", "natural"};
};

/// What runs through the points.
struct CurveOptions {
    CurveKind kind = CurveKind::catmull_rom;  ///< straight or smooth
    bool closed = false;                      ///< a last piece joins the last point to the first
};

template <class Self, class Visitor>
requires SameOptions<Self, CurveOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"kind", "how the curve runs from point to point"}, o.kind);
    visit(Field{"closed", "whether a last piece joins the last point to the first"}, o.closed);
}

/// A cubic c0 + t (c1 + t (c2 + t c3)), 0 <= t <= 1, bent so little that it stays within `slack` of its
/// chord.
struct CurveArc {
    std::array<Vec3d, 4> c;  ///< [m] the coefficients
    double slack = 0;        ///< [m]
    double start = 0;        ///< [m] length of the curve before it
    double length = 0;       ///< [m]

    Vec3d position(double t) const { return c[0] + (c[1] + (c[2] + c[3] * t) * t) * t; }  ///< [m] at t
    /// the first derivative by t
    Vec3d first(double t) const { return c[1] + (c[2] * 2.0 + c[3] * (3.0 * t)) * t; }
    Vec3d second(double t) const { return c[2] * 2.0 + c[3] * (6.0 * t); }  ///< the second derivative by t
    Vec3d tangent(double t) const { return normalized(first(t)); }          ///< of unit length
};

/// Right-handed: tangent = normal x binormal, all of unit length.
struct CurveFrame {
    Vec3d position;  ///< [m] on the curve
    Vec3d tangent;   ///< forward
    Vec3d normal;    ///< x of what is carried along
    Vec3d binormal;  ///< y of what is carried along
};

/// Where on a curve: an arc, and the parameter in it.
struct CurvePlace {
    std::uint32_t arc = 0;  ///< index into Curve::arcs()
    double t = 0;           ///< in [0, 1]
};

/// A curve through points in space; one in a plane has z = 0. It knows its length to about 1e-9, and finds
/// the nearest of all its points, not just a local one. Made in O(n); about 300 bytes a point, more in tight
/// bends.
class Curve {
  public:
    /// Throws InvalidInput when there are fewer than 2 points (3 if closed) or more than a million, when
    /// neighbours coincide, or when one is not a number or beyond 1e9 m.
    explicit Curve(std::span<const Vec3> points, const CurveOptions& options = {});

    bool closed() const { return closed_; }  ///< whether a last piece joins the ends
    /// from point to point
    std::uint32_t piece_count() const { return static_cast<std::uint32_t>(first_arc_.size()) - 1; }
    double length() const { return length_; }  ///< [m]
    Box3 bounds() const { return bounds_; }    ///< [m] holds the curve

    /// `fraction` of the length, clamped to [0, 1].
    CurvePlace at_fraction(double fraction) const;
    /// Parameter i is point i; parameters between run evenly through the piece. Clamped to [0, piece_count].
    CurvePlace at_index(double index) const;
    double fraction(CurvePlace place) const;  ///< part of the length before a place

    /// [m] where a place is
    Vec3d position(CurvePlace place) const { return arcs_[place.arc].position(place.t); }

    /// Frames that turn about the tangent as little as they can [Wang2008]. At the start, normal and binormal
    /// are the world's x and y, turned the shortest way that brings z to the tangent. On a closed curve what
    /// is missing at the end is spread evenly over the length, so that the frames meet.
    CurveFrame frame(CurvePlace place) const;
    double closing_roll() const { return closing_roll_; }  ///< [rad] what was so spread; 0 when open

    /// The nearest point of the curve. O(log n) near the curve. `hint` is a place that may be near; it
    /// changes the time, not the result.
    CurvePlace closest(Vec3d p, CurvePlace hint = {}) const;

    std::span<const CurveArc> arcs() const { return arcs_; }  ///< in order
    const BoxTree& boxes() const { return boxes_; }           ///< of the arcs

  private:
    void cut(std::span<const std::array<Vec3d, 4>> pieces);
    void measure();
    void carry_frames();

    bool closed_ = false;
    std::vector<CurveArc> arcs_;
    std::vector<std::uint32_t> first_arc_;  ///< by piece, and one more
    std::vector<Vec3d> normals_;            ///< at the start of each arc, before the closing roll
    double length_ = 0;
    double closing_roll_ = 0;
    Box3 bounds_;
    BoxTree boxes_;
};

/// The curve itself: the distance is not signed. On the curve the gradient is some unit vector across it.
class CurveShape final : public Shape {
  public:
    explicit CurveShape(Curve curve) : curve_(std::move(curve)) {}  ///< takes the curve over
    Box3 bounds() const override { return curve_.bounds(); }
    void distance(std::span<const Vec3> points, std::span<FieldSample> out) const override;
    bool is_closed() const override { return false; }
    const Curve& curve() const { return curve_; }  ///< the curve

  private:
    Curve curve_;
};

}  // namespace coppice
