#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "coppice/implicit/solid/solid.h"

namespace coppice {

enum class SolidKind : std::uint8_t {
    sphere,
    line,
    circle,
    disc,
    box,
    cylinder,
    cone,
    polyline,
    polygon,
    shape,
    unite,
    intersect,
    subtract,
    blend,
    ricci,
    transform,
    twist,
    taper,
    bend
};

/// One node of the tree, as specified; the members that are used depend on the kind.
struct SolidNode {
    SolidKind kind = SolidKind::sphere;
    std::uint32_t part_count = 1;
    std::uint32_t depth = 1;
    std::vector<Solid> parts;

    /// Primitives: map from the skeleton's own coordinates to space. Transform: the map. Warps: the rigid
    /// frame, z along the axis (bend: z along the line from a, x towards the side).
    Affine map;
    /// disc, cylinder: radius, height from z = 0. cone: radius below, above, height. line: z = height.
    /// circle: radius. box: half sides. twist: rate. taper: height, factor. bend: height, angle. ricci:
    /// exponent.
    Vec3d size;
    double influence = 0;  ///< [m] in the skeleton's own coordinates
    double weight = 1;     ///< the field's value at distance 0
    FieldLaw law = FieldLaw::cube;
    std::vector<Vec3d> points;  ///< polyline, polygon (z = 0), in the skeleton's own coordinates
    bool closed = false;        ///< polyline
    std::shared_ptr<const Shape> shape;
};

/// Returns the maximum distance from the skeleton of a primitive, in its own coordinates, at which its field
/// has the given value: the influence for 0, negative if the value is never reached; at least 0 for a closed
/// shape that reaches it only inside.
double distance_of_value(const SolidNode& primitive, double value);

/// Returns the parameter of a law: a field is (1 - s)^2 (1 - s + share s) of the squared distance s.
constexpr double law_share(FieldLaw law) { return law == FieldLaw::soft ? 5.0 / 9 : 0; }

/// Returns the law at the squared share s, in [0, 1], of the influence.
double law_value(FieldLaw law, double s);

/// Returns the box of {field >= value} (of the support for 0), transformed by `map`.
Box3 compute_box(const Solid& solid, const Affine& map, double value);

}  // namespace coppice
