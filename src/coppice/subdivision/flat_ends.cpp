#include "coppice/subdivision/flat_ends_internal.h"

namespace coppice {

FlatVertices::FlatVertices(const PatchRefinement& patches, std::span<const ClipPlane> clips) {
    if (clips.empty()) return;
    is_flat.resize(patches.vertex_count(), false);
    const FlatEnds ends(clips);
    const PatchStars stars(patches.cage(), patches.levels());
    const auto add = [&](std::uint32_t v, std::uint32_t end) {
        if (is_flat[v]) return;
        const FlatEnds::Place place = ends.of_vertex(stars, patches.levels(), v);
        if (place.end != end) return;
        is_flat[v] = true;
        vertex.push_back(v);
        on_rim.push_back(place.on_rim ? 1 : 0);
    };
    with_grid_size(patches.levels(), [&]<int N>() {
        const PatchIndex<N> index(patches.cage());
        typename PatchIndex<N>::Grid grid;
        for (std::uint32_t end = 0; end < clips.size(); ++end) {
            first.push_back(static_cast<std::uint32_t>(vertex.size()));
            for (std::uint32_t k = 0; k < clips[end].quad_count; ++k) {
                index.grid(clips[end].first_quad + k, grid);
                for (const auto& row : grid) {
                    for (const std::uint32_t v : row) add(v, end);
                }
            }
        }
    });
    first.push_back(static_cast<std::uint32_t>(vertex.size()));
}

}  // namespace coppice
