#pragma once

#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// An octahedron of this radius [m] for every point, to draw a cloud with; of more than half a million points
/// evenly as many as that.
PolygonMesh mesh_of_cloud(const PointSet& points, double radius);

}  // namespace coppice
