#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/tetra/lattice/cells_internal.h"
#include "coppice/tetra/lattice/sizing_internal.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

namespace coppice {

/// Per leaf the slots of the selected tetrahedra, as bits.
using SlotMasks = Buffer<std::uint64_t>;

/// The segments that leaves of the balanced octree intersect, stored for the leaves of the unbalanced one.
class LeafSegments {
  public:
    LeafSegments(const Octree& octree, LatticeSizing sizing);

    std::span<const std::uint32_t> of_leaf(std::uint32_t leaf) const { return sizing_.of_node(node_[leaf]); }
    /// Returns whether both are in the same leaf of the unbalanced octree.
    bool same(std::uint32_t leaf, std::uint32_t other) const { return node_[leaf] == node_[other]; }

  private:
    LatticeSizing sizing_;
    Buffer<std::uint32_t> node_;  ///< per leaf: its node in the sizing
};

/// Selects the tetrahedra that the surface may cross or an axis passes through.
SlotMasks select_tetra(const LatticeCells& cells, const LeafSegments& segments,
                       std::span<const RoundCone> cones, const LatticeCube& cube,
                       const LatticeOptions& options, const Context& ctx);

/// Selects all tetrahedra.
SlotMasks all_tetra(const LatticeCells& cells, const Context& ctx);

struct LatticeMesh {
    TetraMesh mesh;
    std::vector<std::uint32_t> region_leaf;
};

/// Returns the selected tetrahedra, in the order of leaves and slots, and their vertices in the order of
/// leaves.
LatticeMesh gather_tetra(const LatticeCells& cells, const SlotMasks& masks, const LatticeCube& cube,
                         const Context& ctx);

/// Returns for each of these leaves the segments with axes that may pass through the tetrahedra that it owns,
/// ascending.
CompressedRows<std::uint32_t> passing_axes(const LatticeCells& cells, const LeafSegments& segments,
                                           std::span<const RoundCone> cones, const LatticeCube& cube,
                                           std::span<const std::uint32_t> leaves, const Context& ctx);

}  // namespace coppice
