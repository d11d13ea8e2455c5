#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/tetra/polyhedron/regular_internal.h"

namespace coppice::tetra_internal {

/// A triangulation on its grid, in space: the grid's places are floats without rounding.
struct Filling {
    RegularTriangulation cells;
    double unit;  ///< [m] of the grid

    Vec3d at(std::uint32_t vertex) const {
        const GridPlace& p = cells.vertex(vertex).at;
        return Vec3d{double(p[0]), double(p[1]), double(p[2])} * unit;
    }
    /// The nearest place of the grid.
    GridPlace place(Vec3d p) const {
        const auto round = [&](double x) { return static_cast<std::int32_t>(std::lround(x / unit)); };
        return {round(p.x), round(p.y), round(p.z)};
    }
    std::array<Vec3d, 4> corners(std::uint32_t cell) const {
        const auto& v = cells.cells()[cell].vertex;
        return {at(v[0]), at(v[1]), at(v[2]), at(v[3])};
    }
};

/// Whether a plane is known that parts a cone, `times` as large, from a tetrahedron: one along a face of that
/// or across a way to the cone. May be false although they are apart.
bool parted(const RoundCone& cone, double times, const std::array<Vec3d, 4>& corners);

/// For each cone the cells that it meets, `times` as large, and some that it does not: from the cell about
/// one of its ends on, from neighbour to neighbour. O(n + meetings).
CompressedRows<std::uint32_t> cells_near(const Filling& filling, std::span<const RoundCone> cones,
                                         double times, const Context& ctx);

}  // namespace coppice::tetra_internal
