// GLB is written without tinygltf: that library stores the whole file in one vector and copies it into a
// second stream before writing the first byte, which for some hundred megabytes costs more than the rest of
// the export.

#include <optional>
#include <utility>

#include "coppice/io_mesh/glb_parts_internal.h"

namespace coppice::io_internal {
namespace {

using nlohmann::json;

struct Sizes {
    std::uint64_t vectors;  // size of the positions and of the normals in bytes
    std::uint64_t texture;
    std::uint64_t indices;
    std::uint64_t total() const { return 2 * vectors + texture + indices; }
};

json describe(const MeshView& mesh, const Sizes& sizes) {
    Box3 box;
    for (const Vec3 p : mesh.positions) box.extend(y_up(p));
    json node{{"name", "tree"}, {"mesh", 0}};
    if (mesh.has_origin()) node["translation"] = array_of(y_up(mesh.origin));
    json positions = accessor(0, kFloat, mesh.positions.size(), "VEC3");
    positions["min"] = array_of(Vec3d(box.low));
    positions["max"] = array_of(Vec3d(box.high));
    json out{
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
          view(2 * sizes.vectors + sizes.texture, sizes.indices, kElementArrayBuffer)}},
        {"buffers", {{{"byteLength", sizes.total()}}}},
    };
    if (sizes.texture > 0) {
        out["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 3;
        out["accessors"].push_back(accessor(3, kFloat, mesh.positions.size(), "VEC2"));
        out["bufferViews"].push_back(view(2 * sizes.vectors, sizes.texture, kArrayBuffer));
    }
    return out;
}

// In glTF, v points down in the image.
void write_texture(AtomicFile& file, std::span<const TexturePoint> places, const Context& ctx) {
    write_items(file, places.size(), {0.6f, 0.7f}, ctx, [&](std::size_t v, Chunk& chunk) {
        chunk.reserve(sizeof(TexturePoint));
        chunk.put_raw(TexturePoint{places[v].u, 1 - places[v].v});
    });
}

}  // namespace

void write_glb(AtomicFile& file, const MeshView& given, const Context& ctx) {
    const std::optional<SplitMesh> split =
        given.texture.empty() ? std::nullopt : std::optional<SplitMesh>(given);
    const MeshView& mesh = split ? split->view : given;
    std::vector<Vec3> normals = smooth_normals(given);
    if (split) {
        std::vector<Vec3> by_place;
        by_place.reserve(mesh.positions.size());
        for (const std::uint32_t v : split->table.vertex) by_place.push_back(normals[v]);
        normals = std::move(by_place);
    }
    const Sizes sizes{mesh.positions.size() * sizeof(Vec3),
                      split ? mesh.positions.size() * sizeof(TexturePoint) : 0,
                      mesh.triangle_count() * sizeof(Triangle)};
    write_glb_head(file, describe(mesh, sizes).dump(), sizes.total());
    write_vectors(file, mesh.positions, {0, 0.3f}, ctx);
    write_vectors(file, normals, {0.4f, 0.6f}, ctx);
    if (split) write_texture(file, split->table.places, ctx);
    write_triangles(file, mesh, {0.7f, 1}, ctx);
}

}  // namespace coppice::io_internal
