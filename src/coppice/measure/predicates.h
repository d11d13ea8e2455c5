#pragma once

#include <array>

#include "coppice/base/vec.h"

namespace coppice {

/// Exact predicates on points with finite single precision coordinates. A filter in double precision decides
/// nearly always; the rest is decided by exact sums of exact products [Shewchuk1997].

/// Which side of the plane through a, b, c the point d lies on: 1 on the side from which a, b, c run
/// counter-clockwise, -1 on the other, 0 exactly in the plane.
int orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// The turn a, b, c as seen against `axis` (0, 1, 2): 1 to the left, -1 to the right, 0 exactly straight. The
/// other two axes are taken in cyclic order: y, z for 0; z, x for 1; x, y for 2.
int orientation_2d(Vec3 a, Vec3 b, Vec3 c, int axis);

/// Corners of a triangle in space.
using TrianglePoints = std::array<Vec3, 3>;

/// Whether the corners lie exactly on one line.
bool is_degenerate(const TrianglePoints& t);

/// The following hold for triangles that are not degenerate, taken as closed sets: touching counts.

/// Whether two triangles that share no corner have a point in common.
bool triangles_meet(const TrianglePoints& s, const TrianglePoints& t);

/// Whether two triangles that share the corner s[0] = t[0] meet elsewhere: an edge opposite to it meets the
/// other triangle.
bool triangles_meet_beyond_corner(const TrianglePoints& s, const TrianglePoints& t);

/// Whether two triangles that share the edge s[0] s[1] lie in one plane on the same side of it. (If not, they
/// meet in the edge alone.)
bool triangles_overlap_beyond_edge(const TrianglePoints& s, const TrianglePoints& t);

}  // namespace coppice
