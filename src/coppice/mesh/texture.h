#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/column.h"

namespace coppice {

/// Texture coordinates of a corner of a face; the texture repeats. Two corners at one vertex may have
/// different coordinates: a texture seam.
struct TexturePoint {
    float u = 0;                                                   ///< [tiles] around a tube
    float v = 0;                                                   ///< [tiles] along it
    friend bool operator==(TexturePoint, TexturePoint) = default;  ///< compares both coordinates
};

/// A second set of texture coordinates of a corner, which continues the coordinates beyond an edge where
/// those of the surface begin abruptly. Colours, normals and roughness of both sets are interpolated by the
/// weight.
struct TextureBlend {
    TexturePoint second;  ///< in tiles, as the first set
    float weight = 0;     ///< of the second set, from 0 to 1
    friend bool operator==(const TextureBlend&, const TextureBlend&) = default;  ///< compares all values
};

/// Texture coordinates of the corners of a surface, which another object holds.
struct TextureView {
    std::span<const TexturePoint> points;  ///< one per corner of the faces; may be empty
    std::span<const TextureBlend> blends;  ///< the second set; one per corner, or empty
};

/// Quality of a texture.
struct TextureReport {
    std::uint32_t axes = 0;         ///< number of axes, each with its own coordinates
    std::uint64_t transferred = 0;  ///< faces with the coordinates of the closest tube
    std::uint64_t projected = 0;    ///< of these, the faces that are projected on their own plane
    std::uint64_t flipped = 0;      ///< faces that are turned over in the texture
    double density_p5 = 0;          ///< 5 % of the area has at most this density, relative to tiles of the
                                    ///< given width
    double density_p50 = 0;         ///< median by area
    double density_p95 = 0;         ///< 95 % of the area has at most this density
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const TextureReport& r, Visitor&& visit) {
    visit("axes", r.axes);
    visit("transferred", r.transferred);
    visit("projected", r.projected);
    visit("flipped", r.flipped);
    visit("density_p5", r.density_p5);
    visit("density_p50", r.density_p50);
    visit("density_p95", r.density_p95);
}

/// Texture coordinates of a surface.
struct Texture {
    Buffer<TexturePoint> points;  ///< one per corner of the faces, face by face
    TextureReport report;         ///< its quality
    /// one per corner, if they were requested; otherwise empty
    Buffer<TextureBlend> blends = {};
};

}  // namespace coppice
