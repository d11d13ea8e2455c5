#pragma once

#include <span>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Returns the convex hull of finite points [m] as one closed surface of triangles, counter-clockwise seen
/// from outside; its vertices are the points on it, in their order. Returns an empty mesh if all points are
/// exactly in one plane, on one line or at one place.
///
/// Incremental, in an order drawn with a fixed seed, with lists of the points that see each face
/// [Clarkson1989] and exact predicates, so that no input is too flat or too crowded. Expected O(n log n) time
/// and O(n) memory for any input. Less than 2^32 points. Throws Cancelled.
TriMesh convex_hull(std::span<const Vec3> points, const Context& ctx = {});

}  // namespace coppice
