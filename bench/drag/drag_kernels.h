#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/field/field_view.h"
#include "coppice/cuda/quads/quad_kernels_internal.h"
#include "coppice/mesh/normals.h"
#include "drag/drag_job.h"

namespace coppice::bench {

/// Writes the new positions of nodes and their segments.
struct PlaceNodes {
    std::span<const std::uint32_t> which;
    std::span<const MovedNode> moved;
    std::span<Vec3> nodes;
    std::span<cuda::DeviceSegment> segments;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        nodes[which[i]] = moved[i].position;
        segments[which[i]].constants = moved[i].segment;
    }
};

/// Writes the new positions of nodes of tubes.
struct PlaceTubes {
    std::span<const std::uint32_t> which;
    std::span<const Vec3> moved;
    std::span<Vec3> nodes;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { nodes[which[i]] = moved[i]; }
};

/// Writes the new positions of vertices of a cage and their anchors.
struct PlaceVertices {
    std::span<const std::uint32_t> which;
    std::span<const MovedVertex> moved;
    cuda::PointPair cage;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        cage.positions[which[i]] = moved[i].position;
        cage.anchors[which[i]] = moved[i].anchor;
    }
};

/// Copies refined vertices to the drawn vertices.
struct WriteDrawn {
    std::span<const std::uint32_t> from;
    std::span<const Vec3> refined;
    std::span<Vec3> drawn;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { drawn[i] = refined[from[i]]; }
};

/// Computes the normals of drawn vertices.
struct ShadeDrawn {
    std::span<const std::uint32_t> first, fans;
    std::span<const Quad> quads;
    DrawnVertices drawn;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        drawn.normals[i] =
            fan_normal(drawn.positions, quads, fans.subspan(first[i], first[i + 1] - first[i]));
    }
};

}  // namespace coppice::bench
