#pragma once

#include <array>

#include "coppice/base/vec.h"

namespace coppice {

/// Exact predicates on points with finite single precision coordinates. A filter in double precision decides
/// nearly always; the rest is decided by exact sums of exact products [Shewchuk1997].

/// Returns the side of the plane through a, b, c on which the point d is: 1 on the side from which a, b, c
/// are counter-clockwise, -1 on the other, 0 exactly in the plane.
int orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// Returns the direction of the turn a, b, c as seen against `axis` (0, 1, 2): 1 left, -1 right, 0 exactly
/// straight. The other two axes are used in cyclic order: y, z for 0; z, x for 1; x, y for 2.
int orientation_2d(Vec3 a, Vec3 b, Vec3 c, int axis);

/// Corners of a triangle in space.
using TrianglePoints = std::array<Vec3, 3>;

/// Returns whether the corners are exactly on one line.
bool is_degenerate(const TrianglePoints& t);

/// The following functions require triangles that are not degenerate and treat them as closed sets: touching
/// counts as intersection.

/// Returns whether two triangles without a shared corner have a point in common.
bool triangles_meet(const TrianglePoints& s, const TrianglePoints& t);

/// Returns whether two triangles that share the corner s[0] = t[0] intersect elsewhere: an edge opposite to
/// it meets the other triangle.
bool triangles_meet_beyond_corner(const TrianglePoints& s, const TrianglePoints& t);

/// Returns whether two triangles that share the edge s[0] s[1] are in one plane and on the same side of it.
/// (Otherwise they only share the edge.)
bool triangles_overlap_beyond_edge(const TrianglePoints& s, const TrianglePoints& t);

}  // namespace coppice
