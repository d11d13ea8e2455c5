#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/mesh/mesh.h"

namespace coppice {

/// Vertices of a closed path along edges, each joined to the next and the last to the first.
using Loop = std::vector<std::uint32_t>;

/// The boundary of a set of faces.
struct Boundary {
    std::vector<Loop> loops;  ///< in the direction of the edges of the faces; ordered by smallest vertex,
                              ///< which is the first
    std::vector<std::uint32_t> pinched;  ///< vertices at which loops touch; their loops are left out
};

/// Returns the edges of oriented manifold triangles that belong to a single triangle, as loops. If `rim` is
/// given, only edges between vertices that are marked in it, one entry per vertex, are checked. O(n + k log
/// k) for k checked edges.
Boundary compute_boundary(std::span<const Triangle> faces, std::span<const std::uint8_t> rim = {});

}  // namespace coppice
