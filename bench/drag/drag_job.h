#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/vec.h"
#include "coppice/cuda/lists/contact_topology.h"
#include "coppice/cuda/quads/quad_job.h"
#include "coppice/field/kernel/segment_kernel.h"
#include "coppice/mesh/control_mesh.h"

namespace coppice::bench {

/// A surface with a portion that is recomputed in every frame, and all data that remains constant. Referenced
/// data must outlive the object that uses the job.
struct DragJob {
    cuda::QuadJob quads;  ///< the cage of the moving portion at rest; without unfolding
    cuda::ContactInput
        contacts;  ///< the whole skeleton at rest with its tubes, and the moving portion as control mesh

    /// Moving elements, ascending.
    /// @{
    std::span<const std::uint32_t> nodes;       ///< of the skeleton, each with all its descendants
    std::span<const std::uint32_t> tube_nodes;  ///< of the tubes
    std::span<const std::uint32_t> vertices;    ///< of the cage of the portion
    /// @}

    /// Vertices as they are drawn: first those that are written, then others that are shaded, then the rest.
    /// @{
    std::span<const Vec3> drawn;               ///< [m] all of them, at rest
    std::span<const std::uint32_t> from;       ///< per written vertex: the refined vertex of the portion
    std::span<const std::uint32_t> fan_first;  ///< per shaded vertex, plus one: start of its fan
    std::span<const std::uint32_t> fan_quads;  ///< concatenated fans
    std::span<const Quad> quads_about;         ///< the quads of the fans, by drawn vertices
    std::size_t written() const { return from.size(); }          ///< number of drawn vertices that move
    std::size_t shaded() const { return fan_first.size() - 1; }  ///< number of vertices with changing normals
    /// @}
};

/// A node that moved, and the segment that ends there, in the layout of the GPU.
struct alignas(16) MovedNode {
    kernel::SegmentConstants<float> segment;  ///< its current constants
    Vec3 position;                            ///< [m]
};
static_assert(sizeof(MovedNode) == 64);

/// A vertex of the cage that moved.
struct MovedVertex {
    Vec3 position;  ///< [m]
    Vec3 anchor;    ///< [m]
};

/// Positions of all moving elements, in the order of the lists of the job.
struct DragMoves {
    std::span<const MovedNode> nodes;       ///< of DragJob::nodes
    std::span<const Vec3> tube_nodes;       ///< [m] of DragJob::tube_nodes
    std::span<const MovedVertex> vertices;  ///< of DragJob::vertices
    std::span<const ClipPlane> clips;       ///< all flat ends of the portion
};

/// Vertices from which a surface is drawn, in the memory of an executor.
struct DrawnVertices {
    std::span<Vec3> positions;  ///< [m] all of them; those that are not written are at rest
    std::span<Vec3> normals;    ///< at least those that are shaded
};

}  // namespace coppice::bench
