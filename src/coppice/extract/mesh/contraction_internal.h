#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "coppice/extract/mesh/from_mesh.h"
#include "coppice/extract/mesh/surface_internal.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {

struct Contraction {
    InitialTree tree;
    std::vector<std::uint32_t> node;  ///< per vertex: the node that it was merged into
    std::vector<std::pair<std::uint32_t, std::uint32_t>> loops;  ///< ends of edges that close a cycle
};

/// Shrinks a surface to its axes as in [Au2008]: implicit Laplacian smoothing with increasing time steps,
/// then edge collapses until no triangle is left. Two changes: the Laplacian is that of the initial surface
/// [Kazhdan2012], and each vertex stops as soon as the surface around it has become a line, so that thin
/// twigs keep their length while thick branches shrink. Cotangents are clamped, and edges of one triangle or
/// of more than two are smoothed like all others, so that the surface need be neither closed nor manifold.
/// Nodes are at the mean of the vertices merged into them; radii are the median or mean distance of those
/// vertices. About O(n^1.5) for the factorizations, O(n log n) for the collapses.
Contraction contract(const Surface& surface, Thickness thickness, const Context& ctx);

}  // namespace coppice::extract_internal
