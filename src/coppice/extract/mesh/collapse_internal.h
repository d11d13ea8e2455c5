#pragma once

#include <span>

#include "coppice/extract/mesh/contraction_internal.h"

namespace coppice::extract_internal {

/// Collapses the edges of a contracted surface, cheapest first, until no triangle is left [Au2008 section 6].
/// The cost of moving one end onto the other is the quadric error with respect to the edges merged into
/// either end, plus a term for the length of the edges created. The result consists of edges; those that
/// close a cycle are returned as loops. Every component becomes one tree, rooted in the node of its lowest
/// vertex. Radii are not set. O(n log n) for bounded valence.
Contraction collapse_to_graph(const Surface& surface, std::span<const Vec3d> at, const Context& ctx);

}  // namespace coppice::extract_internal
