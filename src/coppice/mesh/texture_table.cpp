#include "coppice/mesh/texture_table.h"

#include "coppice/base/id.h"

namespace coppice {

TextureTable make_texture_table(std::span<const std::uint32_t> corners, const TextureView& texture,
                                std::size_t vertex_count) {
    TextureTable table;
    if (texture.points.empty()) return table;
    table.of_corner.resize(texture.points.size());
    const bool has_blends = !texture.blends.empty();
    const auto is_equal = [&](std::uint32_t place, std::size_t corner) {
        return table.places[place] == texture.points[corner] &&
               (!has_blends || table.blends[place] == texture.blends[corner]);
    };
    std::vector<std::uint32_t> first_of_vertex(vertex_count, kNoIndex), next_of_place;
    for (std::size_t i = 0; i < texture.points.size(); ++i) {
        std::uint32_t& first = first_of_vertex[corners[i]];
        std::uint32_t found = first;
        while (found != kNoIndex && !is_equal(found, i)) found = next_of_place[found];
        if (found == kNoIndex) {
            found = static_cast<std::uint32_t>(table.places.size());
            table.places.push_back(texture.points[i]);
            if (has_blends) table.blends.push_back(texture.blends[i]);
            table.vertex.push_back(corners[i]);
            next_of_place.push_back(first);
            first = found;
        }
        table.of_corner[i] = found;
    }
    return table;
}

}  // namespace coppice
