#pragma once

#include <span>
#include <vector>

#include "coppice/mesh/mesh.h"

namespace coppice {

/// An edge, and the vertex that is put between its ends.
struct EdgeMiddle {
    std::uint32_t a;       ///< one end
    std::uint32_t b;       ///< the other
    std::uint32_t middle;  ///< the vertex
};

/// Quads, and from which triangles they are.
struct QuadPatch {
    std::vector<Quad> quads;              ///< corner of a triangle, middle of an edge, vertex within, middle
    std::vector<std::uint32_t> triangle;  ///< per quad: a triangle of which its corner is one
};

/// Makes quads of triangles: neighbours join in pairs where that gives a good quad, the best first; then
/// every pair is cut into four quads and every triangle left over into three, from the middles of the edges
/// to a vertex in between. The middles of boundary edges are given where there are vertices already; all
/// other new vertices are appended to `positions`, halfway along edges and in the means of faces.
///
/// The triangles must be manifold and oriented. O(n log n).
QuadPatch quadrangulate(std::span<const Triangle> triangles, std::span<const EdgeMiddle> given,
                        Buffer<Vec3>& positions);

/// Cuts pairs again of which a triangle is marked in `alone`: each of both becomes three quads, which lie in
/// its plane where their corners do and middles are halfway. O(n).
void split_pairs(QuadPatch& patch, std::span<const std::uint8_t> alone, Buffer<Vec3>& positions);

}  // namespace coppice
