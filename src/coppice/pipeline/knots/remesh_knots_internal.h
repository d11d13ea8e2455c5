#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/node_join.h"
#include "coppice/pipeline/knots/slices_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice::pipeline_internal {

/// What remeshing did to the refined quads: those that stay come first in the mesh, in their order, and so do
/// their vertices; then come the quads and vertices of the pieces, one after the other.
struct RemeshTrace {
    /// A piece that replaces some slices.
    struct Piece {
        std::vector<Slice> slices;     ///< ascending
        std::uint32_t quads = 0;       ///< how many stand in their place
        std::vector<Slice> beside;     ///< slices that stay, at its seams
        std::vector<NodeId> segments;  ///< of the field's skeleton: all that it was made of
    };
    std::vector<std::uint8_t> is_gone;  ///< per slice; empty: all stay
    std::vector<std::uint32_t> gone;    ///< refined vertices that went, ascending
    std::vector<Piece> pieces;
    /// Whether what became of each place depends on what lies near it alone: not where zones or whole trees
    /// had to be taken, or something was given back.
    bool is_local = true;

    bool stays(Slice s) const { return is_gone.empty() || is_gone[s] == 0; }  ///< whether a slice does
};

/// Per node of some tubes the first root of its tree and all that are joined to it.
std::vector<NodeId> body_roots(const Skeleton& tubes, std::span<const NodeJoin> joins);

/// Replaces the quads of slices that cross others, or themselves, or sever an axis, by quads made of the
/// surface that tetrahedra find there, which never crosses itself, until no quads cross; each round takes
/// more of the tubes, or more care, and at last whole trees. `levels`: how often the surface's cage was
/// refined. What is done about one place does not depend on others, but for that last resort. `wanted`: per
/// tube whether it is looked at, or all; a tube beside those may be replaced with them.
KnotReport remesh_knots(QuadSurface& surface, const TubeMap& map, int levels, const MeshOptions& options,
                        const Context& ctx, RemeshTrace* trace = nullptr,
                        std::span<const std::uint8_t> wanted = {});

}  // namespace coppice::pipeline_internal
