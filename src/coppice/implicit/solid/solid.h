#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/fields.h"
#include "coppice/implicit/shape/shape.h"
#include "coppice/implicit/solid/affine.h"

namespace coppice {

struct SolidNode;

/// A solid modelled by implicit functions: primitives, combined, moved and warped in any nesting, after the
/// BlobTree [Wyvill1999]. Its field is >= 0 and 0 beyond the support; the surface is where the field is
/// `kSurface`, the solid where it is greater. Immutable: a copy is cheap and shares the parts.
///
/// A solid is nested at most 256 deep and has at most 1,000,000 parts, a part used twice counted twice
/// and every point of a polyline or polygon counted.
/// Whatever is built from it throws InvalidInput for numbers that are not finite, too great (coordinates
/// beyond 1e6 m) or without meaning (lengths <= 0).
class Solid {
  public:
    static constexpr float kSurface = 0.5f;  ///< the value on the surface

    /// From a node that this library made.
    explicit Solid(std::shared_ptr<const SolidNode> node) : node_(std::move(node)) {}

    /// Holds every point where the field is greater than 0; empty when there is none. O(parts), as the next.
    Box3 bounds() const { return bounds_at(0); }
    /// Holds the surface and the inside: usually tight for primitives, and wider the more is blended.
    Box3 surface_bounds() const { return bounds_at(kSurface); }
    /// Holds every point where the field is `value` > 0 or more.
    Box3 bounds_at(float value) const;

    std::string_view kind() const;         ///< "sphere", "union", "twist", ...
    std::span<const Solid> parts() const;  ///< direct ones; none for a primitive
    std::uint32_t part_count() const;      ///< all below and this one; points of polylines and polygons count
    std::uint32_t depth() const;           ///< 1 for a primitive

    const SolidNode& node() const { return *node_; }  ///< for the library's own sources

  private:
    std::shared_ptr<const SolidNode> node_;
};

/// How a field falls with the share x = d / R of the influence R that the distance d is. Both are 1 at the
/// skeleton and end without a kink at the influence.
enum class FieldLaw {
    cube,  ///< (1 - x^2)^3: twice differentiable at its end too
    soft   ///< -4/9 x^6 + 17/9 x^4 - 22/9 x^2 + 1 [Wyvill1986]: 1/2 at half the influence
};

template <>
struct EnumNames<FieldLaw> {
    static constexpr std::array<std::string_view, 2> names{"cube", "soft"};
};

/// A primitive's field falls with the distance from its skeleton by the law, times the factor that makes it
/// 0.5 at `radius`.
struct PrimitiveOptions {
    float radius = 1;     ///< [m] distance of the surface from the skeleton
    float influence = 0;  ///< [m] distance where the field ends, 1.1 to 20 radii; 0: 2.2017 radii by the law
                          ///< cube, 2 by soft: the factor is 1
    FieldLaw law = FieldLaw::cube;  ///< how the field falls
};

template <class Self, class Visitor>
requires SameOptions<Self, PrimitiveOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"radius", "distance of the surface from the skeleton", Unit::metre, 1e-5, 1e5}, o.radius);
    visit(
        Field{"influence", "distance where the field ends, 1.1 to 20 radii; 0 = 2.2 radii, by the law soft 2",
              Unit::metre, 0, 1e6},
        o.influence);
    visit(Field{"law",
                "how the field falls with the share x of the influence: (1 - x^2)^3 or "
                "-4/9 x^6 + 17/9 x^4 - 22/9 x^2 + 1"},
          o.law);
}

// Primitives. The skeleton is named by its points; discs, boxes, cones, cylinders and polygons are solid
// skeletons, so that their surfaces have rounded edges. They throw InvalidInput for numbers out of range.
/// A ball: the skeleton is its center.
Solid sphere(Vec3 center, const PrimitiveOptions& options = {});
/// A capsule: the skeleton is the line from a to b.
Solid line(Vec3 a, Vec3 b, const PrimitiveOptions& options = {});
/// A torus: the skeleton is a circle across `axis`.
Solid circle(Vec3 center, Vec3 axis, float circle_radius, const PrimitiveOptions& options = {});
/// A flat disc across `axis` with a round edge.
Solid disc(Vec3 center, Vec3 axis, float disc_radius, const PrimitiveOptions& options = {});
/// A box with rounded edges, `radius` larger than its skeleton on all sides.
Solid box(const Box3& skeleton, const PrimitiveOptions& options = {});
/// A cylinder from a to b with rounded edges.
Solid cylinder(Vec3 a, Vec3 b, float cylinder_radius, const PrimitiveOptions& options = {});
/// The radii are those of the skeleton at a and at b; one of them may be 0.
Solid cone(Vec3 a, Vec3 b, float a_radius, float b_radius, const PrimitiveOptions& options = {});
/// Two points or more, 100,000 at most; `closed` joins the last to the first.
Solid polyline(std::span<const Vec3> points, bool closed = false, const PrimitiveOptions& options = {});
/// A plane face with three corners or more, 10,000 at most; where it crosses itself, inside is what is
/// enclosed an odd number of times. Corners off the plane by more than 1 % of the size are refused.
Solid polygon(std::span<const Vec3> corners, const PrimitiveOptions& options = {});

/// An open shape is a skeleton as those above. Of a closed one the surface is the shape itself: its field is
/// 1 from `influence` below the surface (0: half the least side of its bounds) and falls to 0 at as much
/// above it: evenly to both sides by the law cube, and by soft as if the skeleton lay at that depth.
/// `radius` has no meaning.
Solid solid_of(std::shared_ptr<const Shape> shape, const PrimitiveOptions& options = {});

// Combinations of one or more solids.
Solid unite(std::span<const Solid> parts);      ///< the greatest value
Solid intersect(std::span<const Solid> parts);  ///< the least value
Solid subtract(const Solid& from,
               std::span<const Solid> parts);  ///< min(value, 1 - greatest of the parts'), >= 0
Solid blend(std::span<const Solid> parts);     ///< the sum
/// (sum of value^n)^(1/n), 1 <= exponent <= 100: from the plain sum to the union [Ricci1973].
Solid ricci_blend(std::span<const Solid> parts, float exponent);

// Affine maps: the field is carried along, so that a sphere scaled unevenly is an ellipsoid.
Solid transformed(const Solid& solid, const Affine& map);  ///< stretches and shrinks by 1e7 at most
/// Shifted by a vector [m].
Solid translated(const Solid& solid, Vec3 by);
/// The solid in coordinates that begin at `origin`, as those of a skeleton with an origin of its own.
Solid relative_to(const Solid& solid, Vec3d origin);
Solid rotated(const Solid& solid, Vec3 axis, float angle, Vec3 center = {});  ///< [rad], right-handed
Solid scaled(const Solid& solid, Vec3 factors, Vec3 center = {});  ///< 1e-6 to 1e6 each, negative: mirrored

// Warps [Barr1984].
/// Turns about the line through `origin` along `axis`, by `rate` [rad/m] times the height above origin.
Solid twisted(const Solid& solid, Vec3 origin, Vec3 axis, float rate);
/// Scales across the line from a to b by a factor that goes from 1 at a to `factor` (0.01 to 100) at b and is
/// constant beyond.
Solid tapered(const Solid& solid, Vec3 a, Vec3 b, float factor);
/// Bends the line from a to b into an arc of the same length that leaves a as before and ends turned by
/// `angle` (at most pi [rad]) towards `side`; what lies beyond a and b stays straight. The solid's support
/// must end before the centre of the arc, |b - a| / angle from the line.
Solid bent(const Solid& solid, Vec3 a, Vec3 b, Vec3 side, float angle);

}  // namespace coppice
