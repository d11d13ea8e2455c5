#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/tetra/lattice/cells_internal.h"
#include "coppice/tetra/lattice/sizing_internal.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

namespace coppice {

/// Per leaf the slots of the tetrahedra in use, as bits.
using SlotMasks = Buffer<std::uint64_t>;

/// Those that the surface may cross.
SlotMasks select_tetra(const LatticeCells& cells, const LatticeSizing& sizing,
                       std::span<const RoundCone> cones, const LatticeCube& cube,
                       const LatticeOptions& options, const Context& ctx);

/// All there are.
SlotMasks all_tetra(const LatticeCells& cells, const Context& ctx);

struct LatticeMesh {
    TetraMesh mesh;
    std::vector<std::uint32_t> region_leaf;
};

/// The tetrahedra in use, in the order of leaves and slots, and their vertices in the order of leaves.
LatticeMesh gather_tetra(const LatticeCells& cells, const SlotMasks& masks, const LatticeCube& cube,
                         const Context& ctx);

}  // namespace coppice
