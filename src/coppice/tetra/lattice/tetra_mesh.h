#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice {

/// Four vertices a, b, c, d with dot(cross(b - a, c - a), d - a) > 0.
using Tetra = std::array<std::uint32_t, 4>;

/// The face opposite each vertex of a tetrahedron, counter-clockwise seen from outside.
inline constexpr std::array<std::array<std::uint8_t, 3>, 4> kTetraFaces{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// A region of space divided into tetrahedra without gaps or overlaps: two of them are disjoint or share a
/// vertex, a whole edge, or a whole face. They are stored in runs, one per region, that are contiguous in
/// space.
struct TetraMesh {
    Buffer<Vec3> positions;               ///< [m]
    Buffer<Tetra> tetra;                  ///< sorted by region
    std::vector<std::uint32_t> first{0};  ///< region r has the tetrahedra first[r] .. first[r + 1]
    /// [fine edges] minimum distance between a crossing of the surface and either end of its edge, in (0,
    /// 0.5): large enough that rounding inverts no triangle, larger if tetrahedra are flat
    float clearance = 0.01f;

    /// number of runs
    std::uint32_t region_count() const { return static_cast<std::uint32_t>(first.size() - 1); }
};

/// [m] Returns the bounding box of the tetrahedra of every region. O(n), parallel.
std::vector<Box3> region_boxes(const TetraMesh& mesh, const Context& ctx = {});

/// A face of one tetrahedron, opposite its vertex number `opposite`.
struct TetraFace {
    std::uint32_t tetra = 0;     ///< index of the tetrahedron
    std::uint32_t opposite = 0;  ///< index of the opposite vertex, in [0, 3]
    friend bool operator==(const TetraFace&, const TetraFace&) = default;  ///< member by member
};

}  // namespace coppice
