#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/vec.h"
#include "coppice/cuda/lists/contact_topology.h"
#include "coppice/cuda/quads/quad_job.h"
#include "coppice/field/kernel/segment_kernel.h"
#include "coppice/mesh/control_mesh.h"

namespace coppice::cuda {

/// A surface of which a part is made anew in every frame, and all that stays the same meanwhile. What it
/// refers to has to outlive what it is given to.
struct DragJob {
    QuadJob quads;          ///< the cage of the part at rest; folds are left alone
    ContactInput contacts;  ///< the whole skeleton at rest with its tubes, and the part as control mesh

    /// What moves, ascending.
    /// @{
    std::span<const std::uint32_t> nodes;       ///< of the skeleton, each with all that hangs on it
    std::span<const std::uint32_t> tube_nodes;  ///< of the tubes
    std::span<const std::uint32_t> vertices;    ///< of the part's cage
    /// @}

    /// Vertices as they are drawn: first those that are written, then others that are shaded, then the rest.
    /// @{
    std::span<const Vec3> drawn;               ///< [m] all of them, at rest
    std::span<const std::uint32_t> from;       ///< per written one: the refined vertex of the part
    std::span<const std::uint32_t> fan_first;  ///< per shaded one, and one more: where its fan begins
    std::span<const std::uint32_t> fan_quads;  ///< fan by fan
    std::span<const Quad> quads_about;         ///< the quads of the fans, by drawn vertices
    std::size_t written() const { return from.size(); }          ///< how many drawn vertices move
    std::size_t shaded() const { return fan_first.size() - 1; }  ///< how many have another normal
    /// @}
};

/// A node that moved, and the segment that ends there, as a card reads them.
struct alignas(16) MovedNode {
    kernel::SegmentConstants<float> segment;  ///< as it is now
    Vec3 position;                            ///< [m]
};
static_assert(sizeof(MovedNode) == 64);

/// A vertex of the cage that moved.
struct MovedVertex {
    Vec3 position;  ///< [m]
    Vec3 anchor;    ///< [m]
};

/// Where everything is that moves, in the order of the job's lists.
struct DragMoves {
    std::span<const MovedNode> nodes;       ///< of DragJob::nodes
    std::span<const Vec3> tube_nodes;       ///< [m] of DragJob::tube_nodes
    std::span<const MovedVertex> vertices;  ///< of DragJob::vertices
    std::span<const ClipPlane> clips;       ///< all flat ends of the part
};

/// Where vertices are drawn from, in the memory of an executor.
struct DrawnVertices {
    std::span<Vec3> positions;  ///< [m] all of them; those that are not written are at rest
    std::span<Vec3> normals;    ///< at least those that are shaded
};

}  // namespace coppice::cuda
