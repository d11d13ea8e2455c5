#pragma once

#include <span>
#include <vector>

#include "coppice/mesh/mesh.h"

namespace coppice {

/// An edge, and the vertex that is inserted between its ends.
struct EdgeMiddle {
    std::uint32_t a;       ///< one end
    std::uint32_t b;       ///< the other end
    std::uint32_t middle;  ///< the vertex
};

/// Quads, and the triangles from which they are made.
struct QuadPatch {
    std::vector<Quad> quads;              ///< corner of a triangle, middle of an edge, inner vertex, middle
    std::vector<std::uint32_t> triangle;  ///< per quad: the triangle of its corner
};

/// Converts triangles to quads: adjacent triangles are joined in pairs if that produces a good quad, the best
/// first; triangles that are left are joined along paths of pairs that exchange their triangles, as in the
/// matching of [Remacle2012]; then every pair is cut into four quads and every remaining triangle into three,
/// from the middles of the edges to a vertex in between. The middles of boundary edges are given if there are
/// vertices already; all other new vertices are appended to `positions`, midway along edges and in the means
/// of faces.
///
/// The triangles must be manifold and oriented. O(n log n).
QuadPatch quadrangulate(std::span<const Triangle> triangles, std::span<const EdgeMiddle> given,
                        Buffer<Vec3>& positions);

/// Cuts pairs with a triangle that is marked in `alone` again: each of both becomes three quads, which are in
/// its plane if their corners are and middles are midway. O(n).
void split_pairs(QuadPatch& patch, std::span<const std::uint8_t> alone, Buffer<Vec3>& positions);

}  // namespace coppice
