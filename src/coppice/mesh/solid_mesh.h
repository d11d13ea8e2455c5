#pragma once

#include <array>
#include <cstdint>

#include "coppice/base/column.h"
#include "coppice/base/vec.h"

namespace coppice {

/// Tetrahedral mesh; tetrahedra share whole faces. Corners a, b, c, d with dot(cross(b - a, c - a), d - a) >
/// 0. Float positions are relative to `origin`.
struct SolidMesh {
    Vec3d origin{};                              ///< [m]
    Buffer<Vec3> positions;                      ///< [m]
    Buffer<std::array<std::uint32_t, 4>> tetra;  ///< corners
};

}  // namespace coppice
