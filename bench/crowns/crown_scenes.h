#pragma once

#include <cstddef>

#include "coppice/growth/grow.h"
#include "coppice/implicit/solid/solid.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

/// Creates a typical crown: 64 primitives of five kinds in a tree of blends and unions, then a twist, a
/// hollow cut out, and a trunk blended in. About 13 m high, nested 11 deep.
Solid crown_blob_tree();

/// Creates a ball of 5 m, one primitive.
Solid ball();

/// Creates the attractors of growth: `count` uniform points in an ellipsoid that grows with their number, so
/// that the density is constant: 12,000 in half axes of 4, 4 and 5 m.
PointSet ellipsoid_points(std::size_t count, const Context& ctx);

/// Grows from below that ellipsoid; about 2.2 nodes per attractor.
GrowResult grow_in_ellipsoid(const PointSet& points, const Context& ctx);

/// Computes radii by the pipe model, with twigs of 6 mm, and cleans up the skeleton for a surface.
Skeleton dressed(const Skeleton& grown, const Context& ctx);

}  // namespace coppice::bench
