#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/mesh/half_edges.h"

namespace coppice {

/// A view of the HalfEdges and the vertex fans of a manifold cage of quads, closed or with a boundary, with
/// arrays in the memory of the host or of a GPU: the input of kernels.
struct CageView {
    std::span<const Quad> quads;                              ///< of the cage
    std::span<const std::uint32_t> side;                      ///< see HalfEdges::sides
    std::span<const std::array<std::uint32_t, 2>> edge_half;  ///< see HalfEdges::pairs
    std::span<const std::uint32_t> fan_first;                 ///< offsets into `fan_half`, by vertex
    std::span<const std::uint32_t> fan_half;                  ///< the half-edges that begin at each vertex
    std::span<const std::uint8_t> on_boundary;  ///< per vertex; empty if no edge is on a boundary

    /// including those without quads
    COPPICE_HOST_DEVICE std::uint32_t vertex_count() const {
        return static_cast<std::uint32_t>(fan_first.size() - 1);
    }
    /// edges of one quad or two
    COPPICE_HOST_DEVICE std::uint32_t edge_count() const {
        return static_cast<std::uint32_t>(edge_half.size());
    }
    /// number of quads
    COPPICE_HOST_DEVICE std::uint32_t face_count() const { return static_cast<std::uint32_t>(quads.size()); }
    /// no edge is on a boundary
    COPPICE_HOST_DEVICE bool closed() const { return on_boundary.empty(); }
    /// the half-edges that begin at a vertex, ascending
    COPPICE_HOST_DEVICE std::span<const std::uint32_t> fan(std::uint32_t vertex) const {
        return {fan_half.data() + fan_first[vertex], fan_first[vertex + 1] - fan_first[vertex]};
    }
    /// the vertex at which a half-edge begins
    COPPICE_HOST_DEVICE std::uint32_t corner(std::uint32_t half) const { return quads[half >> 2][half & 3]; }
    /// the two half-edges of a half-edge's edge
    COPPICE_HOST_DEVICE const std::array<std::uint32_t, 2>& pair(std::uint32_t half) const {
        return edge_half[side[half] >> 1];
    }
    /// Returns true for the lower of the one or two half-edges of an edge: its face owns the edge.
    COPPICE_HOST_DEVICE bool owns_edge(std::uint32_t half) const {
        const auto& [forward, backward] = pair(half);
        return half == (forward < backward ? forward : backward);
    }
    /// Returns true for the first half-edge of the fan of its first vertex: its face owns the vertex.
    COPPICE_HOST_DEVICE bool owns_vertex(std::uint32_t half) const { return fan(corner(half))[0] == half; }
};

}  // namespace coppice
