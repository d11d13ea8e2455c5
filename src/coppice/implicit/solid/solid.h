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

/// A solid defined by implicit functions: primitives, combined, transformed and warped in any nesting, as in
/// the BlobTree [Wyvill1999]. Its field is >= 0 and 0 outside the support; the surface is the iso surface at
/// `kSurface`, the solid is where the field is greater. Immutable: a copy is cheap and shares the parts.
///
/// A solid has a nesting depth of at most 256 and at most 1,000,000 parts; parts that are used twice count
/// twice, and every point of a polyline or polygon counts. All construction functions throw InvalidInput for
/// numbers that are not finite, too large (coordinates beyond 1e6 m) or invalid (lengths <= 0).
class Solid {
  public:
    static constexpr float kSurface = 0.5f;  ///< iso value of the surface

    /// Wraps a node made by this library.
    explicit Solid(std::shared_ptr<const SolidNode> node) : node_(std::move(node)) {}

    /// Returns a box of all points with a field greater than 0; empty if there are no such points. O(parts),
    /// as the next.
    Box3 bounds() const { return bounds_at(0); }
    /// Returns a box of the surface and the inside: usually tight for primitives, and wider with more
    /// blending.
    Box3 surface_bounds() const { return bounds_at(kSurface); }
    /// Returns a box of all points with a field of at least `value` > 0.
    Box3 bounds_at(float value) const;

    std::string_view kind() const;         ///< "sphere", "union", "twist", ...
    std::span<const Solid> parts() const;  ///< direct parts; empty for a primitive
    /// Number of all descendants and this one; points of polylines and polygons count.
    std::uint32_t part_count() const;
    std::uint32_t depth() const;  ///< 1 for a primitive

    const SolidNode& node() const { return *node_; }  ///< for the library's own sources

  private:
    std::shared_ptr<const SolidNode> node_;
};

/// Falloff of a field with the ratio x = d / R of the distance d and the influence R. Both laws are 1 at the
/// skeleton and end smoothly at the influence.
enum class FieldLaw {
    cube,  ///< (1 - x^2)^3: twice differentiable, also at its end
    soft   ///< -4/9 x^6 + 17/9 x^4 - 22/9 x^2 + 1 [Wyvill1986]: 1/2 at half the influence
};

template <>
struct EnumNames<FieldLaw> {
    static constexpr std::array<std::string_view, 2> names{"cube", "soft"};
};

/// The field of a primitive decreases with the distance from its skeleton by the law, multiplied by the
/// factor that makes it 0.5 at `radius`.
struct PrimitiveOptions {
    float radius = 1;     ///< [m] distance of the surface from the skeleton
    float influence = 0;  ///< [m] distance at which the field ends, 1.1 to 20 radii; 0: 2.2017 radii for the
                          ///< law cube, 2 for soft: the factor is 1
    FieldLaw law = FieldLaw::cube;  ///< falloff of the field
};

/// Lists the members for front ends.
void list_fields(PrimitiveOptions& o, FieldList& list);

// Primitives. The skeleton is defined by its points; discs, boxes, cones, cylinders and polygons are solid
// skeletons, so that their surfaces have rounded edges. They throw InvalidInput for numbers out of range.
/// A ball: the skeleton is its centre.
Solid sphere(Vec3 center, const PrimitiveOptions& options = {});
/// A capsule: the skeleton is the line from a to b.
Solid line(Vec3 a, Vec3 b, const PrimitiveOptions& options = {});
/// A torus: the skeleton is a circle perpendicular to `axis`.
Solid circle(Vec3 center, Vec3 axis, float circle_radius, const PrimitiveOptions& options = {});
/// A flat disc perpendicular to `axis` with a round edge.
Solid disc(Vec3 center, Vec3 axis, float disc_radius, const PrimitiveOptions& options = {});
/// A box with rounded edges, `radius` larger than its skeleton on all sides.
Solid box(const Box3& skeleton, const PrimitiveOptions& options = {});
/// A cylinder from a to b with rounded edges.
Solid cylinder(Vec3 a, Vec3 b, float cylinder_radius, const PrimitiveOptions& options = {});
/// A cone; the radii are those of the skeleton at a and at b; one of them may be 0.
Solid cone(Vec3 a, Vec3 b, float a_radius, float b_radius, const PrimitiveOptions& options = {});
/// A polyline of 2 to 100,000 points; `closed` connects the last to the first.
Solid polyline(std::span<const Vec3> points, bool closed = false, const PrimitiveOptions& options = {});
/// A plane face with 3 to 10,000 corners; if it intersects itself, areas enclosed an odd number of times are
/// inside. Throws InvalidInput for corners off the plane by more than 1 % of the size.
Solid polygon(std::span<const Vec3> corners, const PrimitiveOptions& options = {});

/// A solid from a shape. An open shape is a skeleton as those above. The surface of a closed one is the shape
/// itself: its field is 1 at a depth of `influence` and more below the surface (0: half the smallest side of
/// its bounds) and decreases to 0 at the same distance above it: symmetrically for the law cube, and for soft
/// as if the skeleton were at that depth. `radius` is ignored.
Solid make_solid(std::shared_ptr<const Shape> shape, const PrimitiveOptions& options = {});

// Combinations of one or more solids.
Solid unite(std::span<const Solid> parts);      ///< maximum of the values
Solid intersect(std::span<const Solid> parts);  ///< minimum of the values
Solid subtract(const Solid& from,
               std::span<const Solid> parts);  ///< min(value, 1 - maximum of the parts' values), >= 0
Solid blend(std::span<const Solid> parts);     ///< sum of the values
/// (sum of value^n)^(1/n), 1 <= exponent <= 100: from the plain sum to the union [Ricci1973].
Solid ricci_blend(std::span<const Solid> parts, float exponent);

// Affine maps: the field is transformed, so that a sphere with non-uniform scale is an ellipsoid.
Solid transformed(const Solid& solid, const Affine& map);  ///< scale factors at most 1e7 and at least 1e-7
/// Translates by a vector [m].
Solid translated(const Solid& solid, Vec3 by);
/// Returns the solid in coordinates relative to `origin`, as those of a skeleton with its own origin.
Solid relative_to(const Solid& solid, Vec3d origin);
Solid rotated(const Solid& solid, Vec3 axis, float angle, Vec3 center = {});  ///< [rad], right-handed
Solid scaled(const Solid& solid, Vec3 factors, Vec3 center = {});  ///< 1e-6 to 1e6 each, negative: mirrored

// Warps [Barr1984].
/// Rotates about the line through `origin` along `axis`, by `rate` [rad/m] times the height above origin.
Solid twisted(const Solid& solid, Vec3 origin, Vec3 axis, float rate);
/// Scales perpendicular to the line from a to b by a factor that changes linearly from 1 at a to `factor`
/// (0.01 to 100) at b and is constant beyond.
Solid tapered(const Solid& solid, Vec3 a, Vec3 b, float factor);
/// Bends the line from a to b into an arc of the same length that starts at a in the original direction and
/// ends rotated by `angle` (at most pi [rad]) towards `side`; the solid stays straight beyond a and b. The
/// solid's support must end before the centre of the arc, |b - a| / angle from the line.
Solid bent(const Solid& solid, Vec3 a, Vec3 b, Vec3 side, float angle);

}  // namespace coppice
