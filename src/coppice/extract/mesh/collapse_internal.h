#pragma once

#include <span>

#include "coppice/extract/mesh/contraction_internal.h"

namespace coppice::extract_internal {

/// Collapses the edges of a contracted surface, cheapest first, until no triangle is left [Au2008 section 6]:
/// the cost of moving one end onto the other is the quadric error of the edges that met in either, and the
/// length of edges drawn. What remains are edges; those that close a way round are given as loops. Every
/// piece is one tree, rooted in the node of its lowest vertex. Radii are not set. O(n log n) for bounded
/// valence.
Contraction collapse_to_graph(const Surface& surface, std::span<const Vec3d> at, const Context& ctx);

}  // namespace coppice::extract_internal
