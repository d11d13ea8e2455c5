#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/pipeline/coarsen/refined_grid_internal.h"
#include "coppice/pipeline/knots/slices_internal.h"

namespace coppice::pipeline_internal {

/// Which refined vertices stay when a surface is coarsened, and what quads they have.
struct Selection {
    std::vector<Quad> quads;               ///< of refined vertices
    std::vector<std::uint32_t> cage_quad;  ///< per quad: the one that holds it, of a transition the first one
    std::vector<float> growth;             ///< per refined vertex: of its distance from its anchor
};

/// Chooses them by the levels of the nodes. O(quads).
Selection select_quads(const RefinedGrid& grid, std::span<const std::uint8_t> node_level);

/// Number of quads of a cage refined so often, where tubes have sides by their radii: what selection begins
/// with, before sections that are not round, bends and crossings ask for more. O(cage).
std::uint64_t faces_by_radius(const ControlMesh& control, const Skeleton& tubes, int levels,
                              float chord_error);

}  // namespace coppice::pipeline_internal
