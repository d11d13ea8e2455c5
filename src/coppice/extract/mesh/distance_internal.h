#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/mesh/surface_internal.h"

namespace coppice::extract_internal {

/// Per vertex the length of the shortest way along the surface from the nearest source, by fast marching over
/// the triangles [Kimmel1998]; infinite where there is none. Every vertex but the sources has a neighbour
/// that is nearer. O(n log n).
std::vector<double> march_distances(const Surface& surface, std::span<const std::uint32_t> sources,
                                    const Context& ctx);

}  // namespace coppice::extract_internal
