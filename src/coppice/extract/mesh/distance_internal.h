#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/mesh/surface_internal.h"

namespace coppice::extract_internal {

/// Returns for each vertex the length of the shortest path along the surface from the closest source,
/// computed by fast marching over the triangles [Kimmel1998]; infinity without a connected source. Every
/// vertex except the sources has a neighbour with a smaller distance. O(n log n).
std::vector<double> march_distances(const Surface& surface, std::span<const std::uint32_t> sources,
                                    const Context& ctx);

}  // namespace coppice::extract_internal
