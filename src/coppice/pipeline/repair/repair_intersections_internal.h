#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/node_join.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/repair/tube_rows_internal.h"

namespace coppice::pipeline_internal {

/// Record of the replaced refined quads: kept quads come first in the mesh, in their order, and so do their
/// vertices; then the quads and vertices of the repair patches follow, patch by patch.
struct RemeshTrace {
    /// A repair patch that replaces some rows.
    struct RepairPatch {
        std::vector<TubeRow> tube_rows;  ///< ascending
        std::uint32_t quads = 0;         ///< number of its quads
        std::vector<TubeRow> adjacent;   ///< kept rows at its cut rings
        std::vector<NodeId> segments;    ///< all segments of the field's skeleton from which it was made
    };
    std::vector<std::uint8_t> is_gone;  ///< per row; empty if all rows are kept
    std::vector<std::uint32_t> gone;    ///< removed refined vertices, ascending
    std::vector<RepairPatch> repair_patches;
    /// Whether the result at each location depends only on its neighbourhood: false if zones or whole trees
    /// were removed, or rows were excluded.
    bool is_local = true;

    bool stays(TubeRow s) const { return is_gone.empty() || is_gone[s] == 0; }  ///< whether a row is kept
};

/// Returns per node of some tubes the first root of its tree and all trees that are joined to it.
std::vector<NodeId> body_roots(const Skeleton& tubes, std::span<const NodeJoin> joins);

/// Replaces the quads of rows that intersect others, or themselves, or sever an axis, by quads made from the
/// surface that tetrahedra find there, which never intersects itself, until no quads intersect; each round
/// removes more of the tubes or raises repair levels, and finally replaces whole trees. `levels`: number of
/// refinements of the surface's cage. The result at one location does not depend on others, except for that
/// last resort. `wanted`: per tube whether it is checked; empty for all. A tube adjacent to these may be
/// replaced with them.
RemeshReport repair_intersections(QuadSurface& surface, const TubeMap& map, int levels,
                                  const MeshOptions& options, const Context& ctx,
                                  RemeshTrace* trace = nullptr, std::span<const std::uint8_t> wanted = {});

}  // namespace coppice::pipeline_internal
