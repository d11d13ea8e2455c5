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

/// A triangulation on its grid with conversion to metres. Grid points are exact in single precision.
struct Filling {
    RegularTriangulation cells;
    double unit;  ///< [m] grid spacing

    Vec3d at(std::uint32_t vertex) const {
        const GridPlace& p = cells.vertex(vertex).at;
        return Vec3d{double(p[0]), double(p[1]), double(p[2])} * unit;
    }
    /// Returns the nearest grid point.
    GridPlace place(Vec3d p) const {
        const auto round = [&](double x) { return static_cast<std::int32_t>(std::lround(x / unit)); };
        return {round(p.x), round(p.y), round(p.z)};
    }
    std::array<Vec3d, 4> corners(std::uint32_t cell) const {
        const auto& v = cells.cells()[cell].vertex;
        return {at(v[0]), at(v[1]), at(v[2]), at(v[3])};
    }
};

/// Returns whether a separating plane is found between a tetrahedron and a cone with its radii multiplied by
/// `times`: parallel to a face of the tetrahedron or perpendicular to a shortest path to the cone. May return
/// false although they are disjoint.
bool parted(const RoundCone& cone, double times, const std::array<Vec3d, 4>& corners);

/// Returns for each cone, with its radii multiplied by `times`, the cells that it intersects and some that it
/// does not. Visits neighbours, starting from the cell at one end of the cone. O(n + intersections).
CompressedRows<std::uint32_t> cells_near(const Filling& filling, std::span<const RoundCone> cones,
                                         double times, const Context& ctx);

}  // namespace coppice::tetra_internal
