#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/mesh/texture.h"

namespace coppice {

/// Texture coordinates listed once for every vertex that uses them: for data with coordinates by vertex, the
/// vertices of the surface after its division at texture seams.
struct TextureTable {
    std::vector<TexturePoint> places;      ///< coordinates
    std::vector<TextureBlend> blends;      ///< per place: the second set; empty without one
    std::vector<std::uint32_t> vertex;     ///< per place: its vertex
    std::vector<std::uint32_t> of_corner;  ///< per corner: its place
};

/// Returns the table of a mesh from the vertices and the coordinates of its corners; empty without
/// coordinates. Places are in the order of their first corners. O(n).
TextureTable make_texture_table(std::span<const std::uint32_t> corners, const TextureView& texture,
                                std::size_t vertex_count);

/// Returns the values of the vertices for every place of the table.
template <class T>
std::vector<T> divide_at_seams(std::span<const T> values, const TextureTable& table) {
    std::vector<T> out;
    out.reserve(table.vertex.size());
    for (const std::uint32_t v : table.vertex) out.push_back(values[v]);
    return out;
}

}  // namespace coppice
