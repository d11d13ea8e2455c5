#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/mesh/mesh.h"

namespace coppice {

/// Vertices of a closed way along edges, each joined to the next and the last to the first.
using Loop = std::vector<std::uint32_t>;

/// Where a set of faces ends.
struct Boundary {
    std::vector<Loop>
        loops;  ///< run as the faces run through their edges; by least vertex, which comes first
    std::vector<std::uint32_t> pinched;  ///< vertices at which loops touch; their loops are left out
};

/// The edges of oriented manifold triangles that have no second one, as loops. Where they are known to run
/// between vertices that are marked in `rim`, one per vertex, others are not looked at. O(n + k log k) for k
/// edges looked at.
Boundary boundary_of(std::span<const Triangle> faces, std::span<const std::uint8_t> rim = {});

}  // namespace coppice
