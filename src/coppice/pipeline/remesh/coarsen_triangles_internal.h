#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/mesh/mesh.h"

namespace coppice {

/// The corner of a grid that is closest to a vertex.
struct GridCorner {
    Vec3 position;      ///< [m] corner
    Vec3 normal;        ///< unit normal of the surface at the vertex
    float spacing = 0;  ///< [m] distance of the lines of the grid; 0 if the vertex stays
};

/// Joins the vertices of each corner of a grid by collapsing edges, and the ends of edges shorter than 0.6
/// spacings, shorter edges first [Botsch2004]. Where a corner belongs to vertices, the closest one is left.
/// Then edges are flipped where that improves the worse of two triangles. No triangle is turned by more than
/// 90 degrees away from the normals of its vertices. `corners`: per vertex. The mesh must be closed and
/// manifold, and remains so; it may intersect itself afterwards. Returns the vertices that are left,
/// ascending; triangles are renumbered. O(n) for bounded valence.
std::vector<std::uint32_t> coarsen_triangles(TriMesh& mesh, std::span<const GridCorner> corners);

}  // namespace coppice
