#pragma once

#include <cstddef>
#include <cstdint>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// A side of a face. Sides are numbered like corners: side s is from corner s to the next one of its face.
struct Side {
    std::uint32_t low;     ///< vertex of the smaller index
    std::uint32_t high;    ///< the other vertex
    std::uint32_t face;    ///< face of the side
    std::uint32_t number;  ///< index of the side
};

/// Returns the sides of a valid mesh sorted by their vertices, so that the sides of one edge are consecutive.
/// O(n).
Buffer<Side> sorted_sides(const PolygonMesh& mesh, const Context& ctx = {});

/// Returns whether sides i and i + 1 are the only two of an edge.
bool are_edge_of_two(const Buffer<Side>& sides, std::size_t i);

}  // namespace coppice
