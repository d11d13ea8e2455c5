#pragma once

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"

namespace coppice::cli {

/// [m] The median distance from a point to its nearest other one, by a sample of a few thousand; 0 for fewer
/// than two points. O(n).
double median_spacing(const PointSet& points, const Context& ctx);

/// An octahedron of this radius [m] for every point, to draw a cloud with; of more than half a million points
/// evenly as many as that.
PolygonMesh drawn_points(const PointSet& points, double radius);

}  // namespace coppice::cli
