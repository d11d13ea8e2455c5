#include "coppice/io_mesh/write_internal.h"

namespace coppice::io_internal {

TextureTable texture_table(const MeshView& mesh) {
    return make_texture_table({mesh.corners, mesh.texture.size()}, {mesh.texture, mesh.texture_blends},
                              mesh.positions.size());
}

SplitMesh::SplitMesh(const MeshView& mesh)
    : table(texture_table(mesh)), positions(divide_at_seams(mesh.positions, table)), view(mesh) {
    view.positions = positions;
    view.corners = table.of_corner.data();
}

std::vector<Vec3> split_vectors(std::span<const Vec3> vectors, const SplitMesh& split) {
    return divide_at_seams(vectors, split.table);
}

}  // namespace coppice::io_internal
