// GLB is written without tinygltf: that library stores the whole file in one vector and copies it into a
// second stream before writing the first byte, which for some hundred megabytes costs more than the rest of
// the export.

#include "coppice/io_mesh/glb_parts_internal.h"

namespace coppice::io_internal {
namespace {

using nlohmann::json;

struct Sizes {
    std::uint64_t vectors;  // size of the positions and of the normals in bytes
    std::uint64_t indices;
    std::uint64_t total() const { return 2 * vectors + indices; }
};

json describe(const MeshView& mesh, const Sizes& sizes) {
    Box3 box;
    for (const Vec3 p : mesh.positions) box.extend(y_up(p));
    json node{{"name", "tree"}, {"mesh", 0}};
    if (mesh.has_origin()) node["translation"] = array_of(y_up(mesh.origin));
    json positions = accessor(0, kFloat, mesh.positions.size(), "VEC3");
    positions["min"] = array_of(Vec3d(box.low));
    positions["max"] = array_of(Vec3d(box.high));
    return {
        {"asset", {{"version", "2.0"}, {"generator", "Coppice"}}},
        {"scene", 0},
        {"scenes", {{{"nodes", {0}}}}},
        {"nodes", {node}},
        {"meshes",
         {{{"name", "surface"},
           {"primitives",
            {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}},
              {"indices", 2},
              {"material", 0},
              {"mode", 4}}}}}}},
        {"materials", {bark_material()}},
        {"accessors",
         {positions, accessor(1, kFloat, mesh.positions.size(), "VEC3"),
          accessor(2, kUnsignedInt, 3 * mesh.triangle_count(), "SCALAR")}},
        {"bufferViews",
         {view(0, sizes.vectors, kArrayBuffer), view(sizes.vectors, sizes.vectors, kArrayBuffer),
          view(2 * sizes.vectors, sizes.indices, kElementArrayBuffer)}},
        {"buffers", {{{"byteLength", sizes.total()}}}},
    };
}

}  // namespace

void write_glb(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    const Sizes sizes{mesh.positions.size() * sizeof(Vec3), mesh.triangle_count() * sizeof(Triangle)};
    write_glb_head(file, describe(mesh, sizes).dump(), sizes.total());
    write_vectors(file, mesh.positions, {0, 0.3f}, ctx);
    write_vectors(file, smooth_normals(mesh), {0.4f, 0.6f}, ctx);
    write_triangles(file, mesh, {0.6f, 1}, ctx);
}

}  // namespace coppice::io_internal
