#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"
#include "coppice/tetra/lattice/refinement_view.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

// Properties of coarse tetrahedra that a refinement uses, computed from their shape.

namespace coppice::tetra_kernel {

/// [m] The corners of a tetrahedron.
using Corners = std::array<Vec3d, 4>;

/// Returns the positions of the first four of these vertices.
template <class Vertices>
COPPICE_HOST_DEVICE Corners get_corners(const Vec3* positions, const Vertices& vertices) {
    return {Vec3d(positions[vertices[0]]), Vec3d(positions[vertices[1]]), Vec3d(positions[vertices[2]]),
            Vec3d(positions[vertices[3]])};
}

/// Returns six times the volume of a tetrahedron; negative if it is inverted.
COPPICE_HOST_DEVICE inline double tetra_volume(const Corners& p) {
    return dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]);
}

/// Returns the corners at the ends of a diagonal: see kTetraDiagonals.
COPPICE_HOST_DEVICE inline std::array<std::uint8_t, 4> diagonal_corners(std::uint32_t diagonal) {
    const auto with = static_cast<std::uint8_t>(diagonal + 1);
    const std::uint8_t first = diagonal == 0 ? 2 : 1, second = diagonal == 2 ? 2 : 3;
    return {0, with, first, second};
}

/// Returns the number of the shortest diagonal of the octahedron in the middle; the first of equal ones.
COPPICE_HOST_DEVICE inline std::uint8_t shortest_diagonal(const Corners& p) {
    std::uint8_t best = 0;
    double best_length = std::numeric_limits<double>::infinity();
    for (std::uint8_t d = 0; d < 3; ++d) {
        const auto c = diagonal_corners(d);
        const double squared = length_squared((p[c[0]] + p[c[1]]) - (p[c[2]] + p[c[3]]));
        if (squared >= best_length) continue;
        best = d;
        best_length = squared;
    }
    return best;
}

/// Minimum dimensions of a tetrahedron.
struct TetraExtent {
    double shortest_edge;  ///< [m] of its descendants, multiplied by their subdivision 2^levels
    double width;          ///< [m] likewise
};

/// Computes the extent. The minimum width of a tetrahedron is between two planes that contain a face and a
/// vertex, or two opposite edges: six times the volume over the length of a cross product of edges. With a
/// path of edges x, y, z through the corners, all these are sums of the products of two of x, y, z; the
/// descendants have the same three edges in another order.
COPPICE_HOST_DEVICE inline TetraExtent tetra_extent(const Corners& p, std::uint8_t diagonal) {
    const auto c = diagonal_corners(diagonal);
    const Vec3d x = p[c[2]] - p[c[0]], y = p[c[1]] - p[c[2]], z = p[c[3]] - p[c[1]];
    double shortest = std::numeric_limits<double>::infinity();
    const std::array<Vec3d, 7> edges{x, y, z, x + y, y + z, x + z, x + y + z};
    for (const Vec3d e : edges) shortest = std::min(shortest, length_squared(e));
    const Vec3d xy = cross(x, y), yz = cross(y, z), xz = cross(x, z);
    double widest = 0;
    const auto add = [&](Vec3d first, Vec3d second, Vec3d ends) {
        const std::array<Vec3d, 7> normals{
            first, second, ends, first + ends, second + ends, second - first, first + ends + second};
        for (const Vec3d n : normals) widest = std::max(widest, length_squared(n));
    };
    add(xy, yz, xz);   // path x, y, z
    add(xz, -yz, xy);  // path x, z, y
    add(-xy, xz, yz);  // path y, x, z
    return {std::sqrt(shortest), std::abs(dot(xy, z)) / std::sqrt(widest)};
}

/// Returns whether a tetrahedron has a positive volume.
COPPICE_HOST_DEVICE inline bool is_sound(const Corners& p) {
    const double volume = tetra_volume(p);
    return volume > 0 && volume <= std::numeric_limits<double>::max();
}

/// Describes a tetrahedron that is cut into eight `levels` times: writes its vertices in ascending order, and
/// all properties that depend on it alone. It owns its interior.
COPPICE_HOST_DEVICE inline void describe_tetra(const Vec3* positions, const Tetra& tetra, int levels,
                                               TetraElements& elements, TetraTraits& traits) {
    Tetra sorted = tetra;
    bool odd = false;
    const auto order = [&](std::size_t i, std::size_t j) {
        if (sorted[i] <= sorted[j]) return;
        const std::uint32_t greater = sorted[i];
        sorted[i] = sorted[j];
        sorted[j] = greater;
        odd = !odd;
    };
    order(0, 1);
    order(2, 3);
    order(0, 2);
    order(1, 3);
    order(1, 2);
    for (std::size_t i = 0; i < 4; ++i) elements[i] = sorted[i];
    const Corners corners = get_corners(positions, sorted);
    const std::uint8_t diagonal = shortest_diagonal(corners);
    const TetraExtent e = tetra_extent(corners, diagonal);
    const double fine = 1.0 / (1 << levels);
    traits = {static_cast<float>(e.shortest_edge * fine), static_cast<float>(e.width * fine),
              static_cast<std::uint16_t>(1u << TetraPattern::kInside), diagonal, odd};
}

}  // namespace coppice::tetra_kernel
