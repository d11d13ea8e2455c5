#pragma once

#include <cstdint>

#include "coppice/mesh/mesh.h"

namespace coppice::bench {

/// Moves every vertex along its normal by Gaussian noise of the given standard deviation [m].
PolygonMesh roughened(const PolygonMesh& mesh, double noise, std::uint64_t seed);

/// Removes the faces with centers within `radius` [m] of one of `count` random vertices. O(count n).
PolygonMesh with_holes(const PolygonMesh& mesh, std::uint32_t count, double radius, std::uint64_t seed);

/// Triangulates faces and collapses random edges to their midpoints, until `share` of the vertices is left or
/// no edge can be collapsed. An edge is collapsed only if the surface remains as manifold as before. O(n) per
/// round, which removes about a fifth of the vertices.
PolygonMesh decimated(const PolygonMesh& mesh, double share, std::uint64_t seed);

}  // namespace coppice::bench
