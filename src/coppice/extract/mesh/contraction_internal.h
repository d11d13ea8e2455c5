#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "coppice/extract/mesh/from_mesh.h"
#include "coppice/extract/mesh/surface_internal.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

struct Contraction {
    DraftTree tree;
    std::vector<std::uint32_t> node;  ///< per vertex: the node that it became part of
    std::vector<std::pair<std::uint32_t, std::uint32_t>> loops;  ///< ends of edges that close a way round
};

/// Shrinks a surface to its axis, after [Au2008]: implicit Laplacian smoothing in growing steps, then edge
/// collapses until no triangle is left. Unlike there the Laplacian is that of the surface at first
/// [Kazhdan2012], and each vertex rests as soon as the surface around it is a line, so that thin twigs keep
/// their length while thick wood shrinks. Cotangents are clamped, and edges of one triangle or of more than
/// two are smoothed like any other, so that the surface need be neither closed nor manifold. Nodes lie in the
/// middle of the vertices that became part of them; radii are the median or mean distance of those. O(n^1.5)
/// or so for the factorisations of surfaces, O(n log n) for the collapses.
Contraction contract(const Surface& surface, Thickness thickness, const Context& ctx);

}  // namespace coppice::extract_internal
