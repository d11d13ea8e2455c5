#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/tetra/lattice/cone_internal.h"
#include "coppice/tetra/lattice/lattice.h"
#include "coppice/tetra/lattice/octree_internal.h"

namespace coppice {

/// The cube that the octree divides. Its side is 8 to 15 eighths of a power of two. Its corners and those of
/// all cells down to `levels`, with their centers, are floats without rounding.
struct LatticeCube {
    Vec3d low;
    double side = 0;
    unsigned levels = 0;  ///< maximum number of subdivisions

    Vec3d at(std::array<std::uint32_t, 3> place) const {
        const double unit = side / Octree::kSide;
        return {low.x + place[0] * unit, low.y + place[1] * unit, low.z + place[2] * unit};
    }
};

/// Creates a cube around the balls of all segments, so large that no cell that contains a surface touches its
/// border. Throws InvalidInput if there are no segments, or one is not finite or has no radius.
LatticeCube lattice_cube(std::span<const Segment> segments, const LatticeOptions& options);

/// Cells as the segments require them, not balanced, and the segments that each leaf intersects, which
/// include all with axes that pass through it.
struct LatticeSizing {
    std::vector<Buffer<std::uint64_t>> split;  ///< see Octree; same numbering of nodes
    Buffer<std::uint32_t> split_number;        ///< per node; kNoIndex for a leaf
    Buffer<std::uint64_t> first;               ///< per node: start of its segments in `segments`
    Buffer<std::uint32_t> count;               ///< per node; 0 except for leaves
    Buffer<std::uint32_t> segments;

    std::span<const std::uint32_t> of_node(std::uint32_t node) const {
        return {segments.data() + first[node], count[node]};
    }
};

/// Splits cells while they are larger than options.cell times the minimum radius of any segment that
/// intersects them, `options.outside` times as thick, unless one segment, `options.inside` times as thick,
/// contains them. Such a leaf lists that segment first, and otherwise only those with axes that pass through
/// it. Cones are relative to the lower corner of the cube. Throws InvalidInput if cells would be too small or
/// too many. About 20 ns for each intersection of a segment with a cell of any level.
LatticeSizing size_cells(std::span<const RoundCone> cones, const LatticeCube& cube,
                         const LatticeOptions& options, const Context& ctx);

}  // namespace coppice
