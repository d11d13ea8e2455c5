#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/pipeline/quads/quad_surface_internal.h"

namespace coppice::pipeline_internal {

/// A surface of quads taken apart: into what is about each tube, and the pieces that remeshing put in.
///
/// Vertices are numbered as refinement does, those that remeshing took out included, so that nothing is
/// renumbered by it; new ones follow. Patch t, for t below the number of tubes, is a tube: the quads that
/// stayed of it, and all vertices that the refinement of its cage quads counts as theirs. Pieces follow, with
/// the quads and vertices that are new there. A tube is named by a node of the skeleton that the surface was
/// made of, and by its place among the tubes of that node: a name that does not change when other parts of
/// the tree do.
struct SurfacePatches {
    std::vector<Vec3> positions;             ///< [m]
    std::vector<Quad> quads;                 ///< those of the mesh
    std::vector<NodeId> node;                ///< per tube
    std::vector<std::uint32_t> place;        ///< per tube
    CompressedRows<std::uint32_t> tubes_of;  ///< per node of the skeleton: its tubes, by place
    std::vector<std::vector<NodeId>>
        piece_nodes;  ///< per piece: the nodes whose tubes it replaces, ascending
    std::vector<std::vector<NodeId>>
        piece_needs;                         ///< the same, and those of all segments that it was made of
    CompressedRows<std::uint32_t> vertices;  ///< per patch, ascending
    CompressedRows<std::uint32_t> quads_of;  ///< per patch, ascending
    std::vector<std::uint32_t> owner;        ///< per vertex: its patch
    std::vector<std::uint32_t> local;        ///< per vertex: its place in that patch

    std::uint32_t tube_count() const { return static_cast<std::uint32_t>(node.size()); }
    std::uint32_t count() const { return static_cast<std::uint32_t>(vertices.size()); }
};

/// `new_of_old`: per node of the skeleton the one of the prepared skeleton that stands for it, as from
/// prepare(). O(n).
SurfacePatches take_apart(const QuadSurface& surface, const QuadTrace& trace,
                          std::span<const NodeId> new_of_old, const Skeleton& prepared);

}  // namespace coppice::pipeline_internal
