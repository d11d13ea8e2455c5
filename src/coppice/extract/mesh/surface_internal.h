#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/mesh/half_edges.h"
#include "coppice/mesh/mesh.h"

namespace coppice::extract_internal {

/// Triangles with adjacency for traversal. Half-edge 3 t + k is directed from corner k of triangle t to the
/// next corner. Edges of more than two triangles are separated: at most two of the triangles are adjacent,
/// the others end there; their vertices remain shared.
struct Surface {
    Buffer<Vec3> positions;             ///< [m] each one is used by a triangle
    std::vector<Triangle> triangles;    ///< three different corners each
    std::vector<std::uint32_t> twin;    ///< per half-edge: the opposite one, kNoIndex at a border
    CompressedRows<std::uint32_t> out;  ///< per vertex: the half-edges that leave it
    std::vector<std::uint32_t>
        component;  ///< per vertex: its component, connected by common vertices, from 0
    std::uint32_t component_count = 0;

    std::uint32_t size() const { return static_cast<std::uint32_t>(positions.size()); }
    std::uint32_t from(std::uint32_t h) const { return triangles[h / 3][h % 3]; }
    std::uint32_t to(std::uint32_t h) const { return from(next_half_edge<3>(h)); }
    std::span<const std::uint32_t> outgoing(std::uint32_t v) const { return out[v]; }
};

/// Counts of special edges found by `connect`.
struct SurfaceFindings {
    std::uint32_t open_edges = 0;
    std::uint32_t non_manifold_edges = 0;  ///< edges of more than two triangles
};

/// Fills twin, out and component from positions and triangles. O(n).
SurfaceFindings connect(Surface& surface, const Context& ctx = {});

/// Flips triangles so that adjacent ones are oriented consistently and each closed component faces outward.
/// Returns the number of flipped triangles. O(n).
std::uint32_t orient(Surface& surface);

/// Returns the border loops of a surface: for each the vertices along it, in order if it is a simple curve.
/// O(n).
std::vector<std::vector<std::uint32_t>> border_loops(const Surface& surface);

/// Returns the area-weighted unit normal of each vertex; zero where the normals of the faces cancel.
std::vector<Vec3> vertex_normals(const Surface& surface, const Context& ctx);

}  // namespace coppice::extract_internal
