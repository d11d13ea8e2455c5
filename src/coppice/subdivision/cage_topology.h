#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Edges and vertex fans of a cage of quads, closed or with a boundary.
///
/// Half-edge h = 4 f + s is side s of quad f: from corner s to corner s + 1. The forward direction of an edge
/// is from its lower to its higher vertex. Edges are numbered by their lower vertex, then by their higher
/// one, so that neighbours in a coherently numbered cage stay neighbours in memory.
struct CageTopology {
    Buffer<Quad> quads;                         ///< the given quads
    Buffer<std::array<std::uint32_t, 4>> side;  ///< per quad and side: 2 edge + (1 if the side is backward)
    Buffer<std::array<std::uint32_t, 2>>
        edge_half;  ///< per edge: forward and backward half-edge, or kNoIndex at a boundary
    CompressedRows<std::uint32_t> fans;  ///< the half-edges that begin at each vertex
    Buffer<std::uint8_t> on_boundary;    ///< per vertex; empty if no edge is on a boundary

    /// including those without quads
    std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(fans.size()); }
    /// edges of one quad or two
    std::uint32_t edge_count() const { return static_cast<std::uint32_t>(edge_half.size()); }
    /// number of quads
    std::uint32_t face_count() const { return static_cast<std::uint32_t>(quads.size()); }
    bool closed() const { return on_boundary.empty(); }  ///< no edge is on a boundary

    /// the vertex at which a half-edge begins
    std::uint32_t corner(std::uint32_t half) const { return quads[half >> 2][half & 3]; }
    /// the next one in its quad
    COPPICE_HOST_DEVICE static std::uint32_t next(std::uint32_t half) {
        return (half & ~3u) | ((half + 1) & 3);
    }
    /// the previous one in its quad
    COPPICE_HOST_DEVICE static std::uint32_t prev(std::uint32_t half) {
        return (half & ~3u) | ((half + 3) & 3);
    }

    /// Returns true for the lower of the one or two half-edges of an edge: its face owns the edge.
    bool owns_edge(std::uint32_t half) const {
        const auto& pair = edge_half[side[half >> 2][half & 3] >> 1];
        return half == (pair[0] < pair[1] ? pair[0] : pair[1]);
    }
    /// Returns true for the first half-edge of the fan of its first vertex: its face owns the vertex.
    bool owns_vertex(std::uint32_t half) const { return fans[corner(half)].front() == half; }
};

/// Returns the half-edges that begin at each vertex, ascending. O(n).
CompressedRows<std::uint32_t> vertex_fans(std::span<const Quad> quads, std::uint32_t vertex_count);

/// Builds the topology of a cage. O(n), also with vertices of thousands of faces (n log n in their valence).
/// Vertices without faces are allowed. Throws InvalidInput naming the quad or the edge if an index is out of
/// range, a quad repeats a vertex, an edge has more than two faces, or its two faces do not have opposite
/// directions along it.
CageTopology build_cage_topology(std::span<const Quad> quads, std::uint32_t vertex_count,
                                 const Context& ctx = {});

}  // namespace coppice
