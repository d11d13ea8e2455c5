#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/context.h"
#include "coppice/mesh/face_view.h"
#include "coppice/mesh/statistics.h"

namespace coppice {

/// Quality of the shapes of the faces of a mesh.
struct ShapeReport {
    /// Per face: the minimum sine of the corner angles, negative for a corner that is oriented against the
    /// normal of the face, -1 for a face without area. For triangles divided by the sine of 60 degrees, so
    /// that 1 is the optimum for both.
    Statistics scaled_jacobian;
    std::uint64_t inverted_faces = 0;  ///< scaled Jacobian <= 0
    double signed_volume = 0;          ///< [m^3] positive for outward faces; not meaningful for open meshes
    double area = 0;                   ///< [m^2]
    friend bool operator==(const ShapeReport&, const ShapeReport&) = default;  ///< compares all members
};

/// Measures the shapes of a valid mesh. O(n).
ShapeReport shape(const FaceView& mesh, const Context& ctx = {});

/// Returns the signed volume of a valid mesh in m^3, as in ShapeReport. O(n).
double signed_volume(const FaceView& mesh, const Context& ctx = {});

/// Returns the scaled Jacobian of one face.
double scaled_jacobian(std::span<const std::uint32_t> face, std::span<const Vec3> positions);

/// Returns the corner from which a face is divided into a fan of triangles, computed in double precision:
/// quads along their shorter diagonal.
std::uint32_t fan_corner(std::span<const std::uint32_t> face, std::span<const Vec3> positions);

/// Calls visit(Triangle) for the fan of a face.
template <class Visit>
void for_each_triangle(std::span<const std::uint32_t> face, std::span<const Vec3> positions,
                       const Visit& visit) {
    const std::size_t n = face.size(), o = fan_corner(face, positions);
    for (std::size_t k = 1; k + 1 < n; ++k)
        visit(Triangle{face[o], face[(o + k) % n], face[(o + k + 1) % n]});
}

}  // namespace coppice
