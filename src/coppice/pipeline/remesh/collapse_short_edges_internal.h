#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/mesh/mesh.h"

namespace coppice {

/// Moves one end of edges that are shorter than four fifths of `edge` onto the other end, shorter edges
/// first, as in isotropic remeshing [Botsch2004]. No new edge is longer than four thirds of it, and no
/// triangle turns by more than 45 degrees. `edge`: per vertex the length of edges in m; the shorter one of
/// both ends decides, and edges of length 0 stay. The mesh must be closed and manifold, and remains so; it
/// may intersect itself afterwards. Returns the vertices that are left, ascending; triangles are renumbered.
/// O(n) for bounded valence.
std::vector<std::uint32_t> collapse_short_edges(TriMesh& mesh, std::span<const float> edge);

}  // namespace coppice
