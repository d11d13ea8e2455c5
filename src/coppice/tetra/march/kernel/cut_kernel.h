#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"

namespace coppice::tetra_kernel {

/// The polygon of the surface within a fine tetrahedron, counter-clockwise seen from outside. Corners 0 to 5
/// are on edges 01, 02, 03, 12, 13, 23; corners 6 to 9 are the vertices 0 to 3.
struct Cut {
    std::uint8_t size = 0;                  ///< 0, 3 or 4
    std::array<std::uint8_t, 4> corners{};  ///< the first `size` of them
};
inline constexpr std::uint8_t kCutVertex = 6;  ///< the corner that is vertex 0

/// Indexed by 16 times the bits of the corners that are inside, plus the bits of those on the surface.
extern const std::array<Cut, 256> kCuts;

/// Reverses the orientation of a polygon.
COPPICE_HOST_DEVICE inline void turn_round(std::array<std::uint32_t, 4>& corners, std::uint32_t size) {
    const std::uint32_t first = corners[0];
    corners[0] = corners[size - 1];
    corners[size - 1] = first;
    if (size < 4) return;
    const std::uint32_t second = corners[1];
    corners[1] = corners[2];
    corners[2] = second;
}

/// Returns whether a polygon of four corners is cut into triangles along its diagonal from the first one.
COPPICE_HOST_DEVICE inline bool cut_from_first(const Vec3* p, const std::array<std::uint32_t, 4>& c) {
    return length_squared(p[c[0]] - p[c[2]]) <= length_squared(p[c[1]] - p[c[3]]);
}

/// Writes the one or two triangles of a polygon, cut along its shorter diagonal; returns the pointer past
/// them.
COPPICE_HOST_DEVICE inline std::array<std::uint32_t, 3>* write_polygon(const Vec3* positions,
                                                                       const std::array<std::uint32_t, 4>& c,
                                                                       std::uint32_t size,
                                                                       std::array<std::uint32_t, 3>* out) {
    if (size == 3) {
        *out++ = {c[0], c[1], c[2]};
        return out;
    }
    if (cut_from_first(positions, c)) {
        *out++ = {c[0], c[1], c[2]};
        *out++ = {c[0], c[2], c[3]};
    } else {
        *out++ = {c[0], c[1], c[3]};
        *out++ = {c[1], c[2], c[3]};
    }
    return out;
}

}  // namespace coppice::tetra_kernel
