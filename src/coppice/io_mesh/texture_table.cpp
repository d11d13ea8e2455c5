#include "coppice/base/id.h"
#include "coppice/io_mesh/write_internal.h"

namespace coppice::io_internal {

TextureTable texture_table(const MeshView& mesh) {
    TextureTable table;
    if (mesh.texture.empty()) return table;
    table.of_corner.resize(mesh.texture.size());
    std::vector<std::uint32_t> first_of_vertex(mesh.positions.size(), kNoIndex), next_of_place;
    for (std::size_t i = 0; i < mesh.texture.size(); ++i) {
        std::uint32_t& first = first_of_vertex[mesh.corners[i]];
        std::uint32_t found = first;
        while (found != kNoIndex && table.places[found] != mesh.texture[i]) found = next_of_place[found];
        if (found == kNoIndex) {
            found = static_cast<std::uint32_t>(table.places.size());
            table.places.push_back(mesh.texture[i]);
            table.vertex.push_back(mesh.corners[i]);
            next_of_place.push_back(first);
            first = found;
        }
        table.of_corner[i] = found;
    }
    return table;
}

SplitMesh::SplitMesh(const MeshView& mesh) : table(texture_table(mesh)), view(mesh) {
    positions.reserve(table.places.size());
    for (const std::uint32_t v : table.vertex) positions.push_back(mesh.positions[v]);
    view.positions = positions;
    view.corners = table.of_corner.data();
}

std::vector<Vec3> split_vectors(std::span<const Vec3> vectors, const SplitMesh& split) {
    std::vector<Vec3> out;
    out.reserve(split.positions.size());
    for (const std::uint32_t v : split.table.vertex) out.push_back(vectors[v]);
    return out;
}

}  // namespace coppice::io_internal
