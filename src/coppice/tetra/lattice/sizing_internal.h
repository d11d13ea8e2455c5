#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/tetra/lattice/cone_internal.h"
#include "coppice/tetra/lattice/lattice.h"
#include "coppice/tetra/lattice/octree_internal.h"

namespace coppice {

/// The cube that the octree cuts. Its side is a power of two, and its corners and those of all cells down to
/// `levels`, with their centers, are floats without rounding.
struct LatticeCube {
    Vec3d low;
    double side = 0;
    unsigned levels = 0;  ///< how often it may be cut

    Vec3d at(std::array<std::uint32_t, 3> place) const {
        const double unit = side / Octree::kSide;
        return {low.x + place[0] * unit, low.y + place[1] * unit, low.z + place[2] * unit};
    }
};

/// Around the balls of all segments, so large that no cell with a surface in it touches its border.
/// Throws InvalidInput for no segments, or one that is not finite or has no radius.
LatticeCube lattice_cube(std::span<const Segment> segments, const LatticeOptions& options);

/// Cells as the segments ask for them, not balanced, and which segments each leaf meets: all whose axes pass
/// through it are among them.
struct LatticeSizing {
    std::vector<Buffer<std::uint64_t>> split;  ///< see Octree; nodes are numbered as there
    Buffer<std::uint32_t> split_number;        ///< per node; kNone for a leaf
    Buffer<std::uint64_t> first;               ///< per node: where its segments begin in `segments`
    Buffer<std::uint32_t> count;               ///< per node; only leaves have any
    Buffer<std::uint32_t> segments;

    std::span<const std::uint32_t> of_node(std::uint32_t node) const {
        return {segments.data() + first[node], count[node]};
    }
};

/// Cells are split while larger than options.cell times the least radius of any segment that meets them,
/// `options.outside` times as thick, unless one segment, `options.inside` times as thick, holds them (such
/// a leaf names that segment first, and else only those whose axes pass through it). Cones are relative to
/// the cube's lower corner. Throws InvalidInput when cells would be too small or too many. Some 20 ns for
/// each meeting of a segment with a cell of any level.
LatticeSizing size_cells(std::span<const RoundCone> cones, const LatticeCube& cube,
                         const LatticeOptions& options, const Context& ctx);

}  // namespace coppice
