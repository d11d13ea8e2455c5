#pragma once

#include <cstdint>

#include "coppice/mesh/mesh.h"

namespace coppice::bench {

/// Every vertex moves along its normal by Gaussian noise of that standard deviation [m].
PolygonMesh roughened(const PolygonMesh& mesh, double noise, std::uint64_t seed);

/// Leaves out the faces whose middles lie within `radius` [m] of one of `count` vertices drawn at random.
/// O(count n).
PolygonMesh with_holes(const PolygonMesh& mesh, std::uint32_t count, double radius, std::uint64_t seed);

/// Cuts faces into triangles and collapses edges to their middles, drawn at random all over the mesh, until
/// `share` of the vertices is left or no edge can go. An edge goes where that keeps the surface as manifold
/// as it was. O(n) a round, about a fifth of the vertices going in each.
PolygonMesh decimated(const PolygonMesh& mesh, double share, std::uint64_t seed);

}  // namespace coppice::bench
