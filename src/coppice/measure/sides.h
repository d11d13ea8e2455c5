#pragma once

#include <cstddef>
#include <cstdint>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// A side of a face. Sides are numbered as corners are: side s runs from corner s to the next one of its
/// face.
struct Side {
    std::uint32_t low;     ///< its vertex of lower number
    std::uint32_t high;    ///< its other vertex
    std::uint32_t face;    ///< to which it belongs
    std::uint32_t number;  ///< its own
};

/// The sides of a valid mesh by their vertices, so that those of one edge follow each other. O(n).
Buffer<Side> sorted_sides(const PolygonMesh& mesh, const Context& ctx = {});

/// Whether sides i and i + 1 are the only two of an edge.
bool are_edge_of_two(const Buffer<Side>& sides, std::size_t i);

}  // namespace coppice
