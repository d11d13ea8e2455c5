#include "coppice/subdivision/kernel/flat_ends.h"

namespace coppice {

FlatVertices::FlatVertices(const PatchStars& stars, int levels, std::span<const ClipPlane> clips) {
    if (clips.empty()) return;
    is_flat.resize(stars.vertex_count(), false);
    const FlatEnds ends(clips);
    const auto add = [&](std::uint32_t v, std::uint32_t end) {
        if (is_flat[v]) return;
        const FlatEnds::Place place = ends.of_vertex(stars, levels, v);
        if (place.end != end) return;
        is_flat[v] = true;
        vertex.push_back(v);
        on_rim.push_back(place.on_rim ? 1 : 0);
    };
    const std::uint32_t n = 1u << levels;
    for (std::uint32_t end = 0; end < clips.size(); ++end) {
        first.push_back(static_cast<std::uint32_t>(vertex.size()));
        for (std::uint32_t k = 0; k < clips[end].quad_count; ++k) {
            for (std::uint32_t row = 0; row <= n; ++row) {
                for (std::uint32_t column = 0; column <= n; ++column)
                    add(stars.vertex(clips[end].first_quad + k, column, row), end);
            }
        }
    }
    first.push_back(static_cast<std::uint32_t>(vertex.size()));
}

}  // namespace coppice
