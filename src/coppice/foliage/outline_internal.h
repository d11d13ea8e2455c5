#pragma once

#include <vector>

#include "coppice/foliage/leaf_shape.h"

namespace coppice::foliage_internal {

/// A point of a flat leaf.
struct Point2 {
    float x = 0;                                       ///< [m] to the right
    float y = 0;                                       ///< [m] along the leaf
    friend bool operator==(Point2, Point2) = default;  ///< compares both coordinates
};

inline Point2 operator+(Point2 a, Point2 b) { return {a.x + b.x, a.y + b.y}; }
inline Point2 operator-(Point2 a, Point2 b) { return {a.x - b.x, a.y - b.y}; }
inline Point2 operator*(Point2 a, float s) { return {a.x * s, a.y * s}; }

/// A line across the right half of a blade, along a secondary vein.
struct BladeRow {
    float t = 0;   ///< parameter of the row: 0 at the base, 1 at the tip
    Point2 inner;  ///< [m] on the midrib, or at the petiole of palmate blades
    Point2 outer;  ///< [m] on the margin
};

/// Returns the exponents of the half-width of a shape: those of the outline, unless they are given.
struct OutlineExponents {
    float base = 0;   ///< at the base
    float tip = 0;    ///< at the tip
    float heart = 0;  ///< length of the lobes behind the petiole per length of the blade
};
OutlineExponents find_exponents(const LeafShape& shape);

/// Returns the half-width at t in [0, 1], 1 at its maximum.
float compute_half_width(const OutlineExponents& e, float t);

/// Returns the angles of the lobes on the right side of a palmate blade from the midrib, outwards [rad].
std::vector<float> find_lobe_angles(const LeafShape& shape);

/// Returns the parameter of the row at an angle from the midrib of a palmate blade.
float find_row_at_angle(float angle);

/// Returns the rows of the right half of a blade from the base to the tip, `count` + 1 or more of them where
/// the margin has teeth.
std::vector<BladeRow> make_rows(const LeafShape& shape, int count);

}  // namespace coppice::foliage_internal
