#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// A surface of quads, divided into the patches of each tube, and the repair patches of remeshing.
///
/// Vertices are numbered as by refinement, including those that remeshing removed, so that it renumbers no
/// vertex; new ones follow. Patch t, for t below the number of tubes, is a tube: its kept quads, and all
/// vertices that the refinement assigns to its cage quads. Repair patches follow, with their new quads and
/// vertices. A tube is identified by a node of the skeleton of the surface, and by its index among the tubes
/// of that node: a name that does not change when other parts of the tree do.
struct SurfacePatches {
    std::vector<Vec3> positions;             ///< [m]
    std::vector<Quad> quads;                 ///< those of the mesh
    std::vector<NodeId> node;                ///< per tube
    std::vector<std::uint32_t> place;        ///< per tube
    CompressedRows<std::uint32_t> tubes_of;  ///< per node of the skeleton: its tubes, by index
    std::vector<std::vector<NodeId>>
        piece_nodes;  ///< per repair patch: the nodes of the tubes that it replaces, ascending
    std::vector<std::vector<NodeId>>
        piece_needs;                         ///< the same, and those of all segments from which it was made
    CompressedRows<std::uint32_t> vertices;  ///< per patch, ascending
    CompressedRows<std::uint32_t> quads_of;  ///< per patch, ascending
    std::vector<std::uint32_t> owner;        ///< per vertex: its patch
    std::vector<std::uint32_t> local;        ///< per vertex: its index in that patch

    std::uint32_t tube_count() const { return static_cast<std::uint32_t>(node.size()); }
    std::uint32_t count() const { return static_cast<std::uint32_t>(vertices.size()); }
};

/// `new_of_old`: per node of the skeleton the corresponding node of the prepared skeleton, as from prepare().
/// O(n).
SurfacePatches take_apart(const QuadMesh& mesh, const QuadBuild& build, std::span<const NodeId> new_of_old,
                          const Skeleton& prepared);

}  // namespace coppice::pipeline_internal
