#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/pipeline/coarsen/refined_grid_internal.h"
#include "coppice/pipeline/repair/tube_rows_internal.h"

namespace coppice::pipeline_internal {

/// The refined vertices that are kept when a surface is coarsened, and their quads.
struct Selection {
    CoarseQuads made;           ///< the quads
    std::vector<float> growth;  ///< per refined vertex: relative growth of its distance from its anchor
};

/// Selects them by the levels of the nodes. O(quads).
Selection select_quads(const RefinedGrid& grid, std::span<const std::uint8_t> node_level);

/// Returns the number of quads of a cage with this number of levels if tubes have sides by their radii: the
/// initial state of the selection, before sections that are not circular, bends and crossings require more.
/// O(cage).
std::uint64_t faces_by_radius(const ControlMesh& control, const Skeleton& tubes, int levels,
                              float chord_error);

}  // namespace coppice::pipeline_internal
