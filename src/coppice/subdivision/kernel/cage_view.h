#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/subdivision/cage_topology.h"

namespace coppice {

/// A view of a CageTopology with arrays in the memory of the host or of a GPU: the input of kernels.
struct CageView {
    std::span<const Quad> quads;                              ///< see CageTopology
    std::span<const std::array<std::uint32_t, 4>> side;       ///< see CageTopology
    std::span<const std::array<std::uint32_t, 2>> edge_half;  ///< see CageTopology
    std::span<const std::uint32_t> fan_first;                 ///< offsets into `fan_half`, by vertex
    std::span<const std::uint32_t> fan_half;                  ///< the half-edges that begin at each vertex
    std::span<const std::uint8_t> on_boundary;                ///< see CageTopology

    CageView() = default;  ///< without quads
    /// View of a topology, which must outlive it.
    CageView(const CageTopology& cage)
        : quads(cage.quads),
          side(cage.side),
          edge_half(cage.edge_half),
          fan_first(cage.fans.first),
          fan_half(cage.fans.items),
          on_boundary(cage.on_boundary) {}

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
        return edge_half[side[half >> 2][half & 3] >> 1];
    }
    /// see CageTopology
    COPPICE_HOST_DEVICE bool owns_edge(std::uint32_t half) const {
        const auto& [forward, backward] = pair(half);
        return half == (forward < backward ? forward : backward);
    }
    /// see CageTopology
    COPPICE_HOST_DEVICE bool owns_vertex(std::uint32_t half) const { return fan(corner(half))[0] == half; }
};

}  // namespace coppice
