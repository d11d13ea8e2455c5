#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"
#include "coppice/tetra/lattice/shape_kernel.h"

namespace coppice::tetra_kernel {

/// [m] Returns the distance that two vertices of a fine tetrahedron of this width may move in total without
/// inverting it.
COPPICE_HOST_DEVICE inline float harmless_way(float width) { return 0.94f * width; }

/// [m] Returns the total distance of the two vertices that moved farthest.
COPPICE_HOST_DEVICE inline float two_longest(const std::array<float, 4>& way) {
    const float ab = std::max(way[0], way[1]), cd = std::max(way[2], way[3]);
    return std::max(std::max(way[0] + way[1], way[2] + way[3]), ab + cd);
}

/// Returns whether a tetrahedron is inverted or too flat; `before` is six times its original volume. Both may
/// be negative: the order of the vertices is that of the pattern.
COPPICE_HOST_DEVICE inline bool is_flat(const std::array<Vec3d, 4>& p, double before) {
    constexpr double kMin = 0.15;  // minimum fraction of the original volume
    return !(tetra_volume(p) / before > kMin);
}

/// Returns the vertex of a tetrahedron that moved farthest; of equal ones the one with the smallest number.
COPPICE_HOST_DEVICE inline std::uint32_t farthest(const std::array<std::uint32_t, 4>& vertex,
                                                  const std::array<float, 4>& way) {
    std::uint32_t out = 0;
    float longest = -1;
    for (std::size_t i = 0; i < 4; ++i) {
        if (way[i] < longest || (way[i] == longest && vertex[i] > out)) continue;
        longest = way[i];
        out = vertex[i];
    }
    return out;
}

}  // namespace coppice::tetra_kernel
