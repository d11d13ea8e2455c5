#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/mesh/face_view.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/texture.h"
#include "coppice/pipeline/mesh_options.h"

namespace coppice::pipeline_internal {

/// Returns the positions of the corners of a face.
template <std::size_t N>
std::array<Vec3, N> face_positions(const std::array<std::uint32_t, N>& face,
                                   std::span<const Vec3> positions) {
    std::array<Vec3, N> out;
    for (std::size_t k = 0; k < N; ++k) out[k] = positions[face[k]];
    return out;
}

/// [tiles^2] Returns the area of a triangle in the texture, negative if it is turned over.
inline double signed_area(TexturePoint a, TexturePoint b, TexturePoint c) {
    return 0.5 * ((double{b.u} - a.u) * (double{c.v} - a.v) - (double{c.u} - a.u) * (double{b.v} - a.v));
}

/// [tiles^2] Returns the area of a face in the texture, negative if it is turned over.
inline double texture_area(std::span<const TexturePoint> face) {
    double out = 0;
    for (std::size_t k = 1; k + 1 < face.size(); ++k) out += signed_area(face[0], face[k], face[k + 1]);
    return out;
}

/// Returns whether no corner of a face is turned over in the texture, and its density is within a factor of
/// four of the expected one.
bool is_good_texture(std::span<const Vec3> face, std::span<const TexturePoint> texture,
                     float tiles_per_metre);

/// The widths of tiles by face.
struct TileWidths {
    float tile;                         ///< [m] of faces that are not on twigs
    SlotOptions slots = {};             ///< tile and diameter of twigs
    std::span<const float> radii = {};  ///< [m] per face as in BarkTexture, if slots.twigs

    float at(std::size_t face) const {
        const bool is_twig =
            slots.twigs && slots.twig_tile > 0 && radii[face] >= 0 && 2 * radii[face] < slots.twig_diameter;
        return is_twig ? slots.twig_tile : tile;
    }
};

/// A plane through a point, in which v increases towards the projection of a direction.
struct TexturePlane {
    Vec3 point;
    Vec3 normal;  ///< of any length
    Vec3 along;   ///< unit
};

/// Sets the coordinates of a face to those of its projection on a plane, seen from where the normal points
/// to.
void project_on_plane(std::span<const Vec3> face, const TexturePlane& plane, float tiles_per_metre,
                      std::span<TexturePoint> out);

/// Adds the number of faces that are turned over and the quantiles of the density, by area. O(n log n).
void measure_texture(std::span<const Quad> faces, std::span<const Vec3> positions,
                     std::span<const TexturePoint> texture, const TileWidths& tiles, TextureReport& report,
                     const Context& ctx);
void measure_texture(std::span<const Triangle> faces, std::span<const Vec3> positions,
                     std::span<const TexturePoint> texture, const TileWidths& tiles, TextureReport& report,
                     const Context& ctx);
void measure_texture(const FaceView& mesh, std::span<const TexturePoint> texture, const TileWidths& tiles,
                     TextureReport& report, const Context& ctx);

}  // namespace coppice::pipeline_internal
