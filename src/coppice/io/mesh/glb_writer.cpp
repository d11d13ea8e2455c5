// GLB is written by hand, not with tinygltf: that library holds the whole file in one vector and copies it
// into a second stream before the first byte is written, which for some hundred megabytes costs more than the
// rest of the work.

#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "coppice/io/mesh/write_internal.h"

namespace coppice::io_internal {
namespace {

using nlohmann::json;

constexpr int kFloat = 5126;  // values of glTF 2.0, sections 3.6 and 5.11
constexpr int kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;

template <class T>
BasicVec3<T> y_up(BasicVec3<T> v) {
    return {v.x, v.z, -v.y};
}

json array_of(Vec3d v) { return json::array({v.x, v.y, v.z}); }

struct Sizes {
    std::uint64_t vectors;  // bytes of the positions, and of the normals
    std::uint64_t indices;
    std::uint64_t total() const { return 2 * vectors + indices; }
};

json describe(const MeshView& mesh, const Sizes& sizes) {
    Box3 box;
    for (const Vec3 p : mesh.positions) box.extend(y_up(p));
    json node{{"name", "tree"}, {"mesh", 0}};
    if (mesh.has_origin()) node["translation"] = array_of(y_up(mesh.origin));
    const auto view = [](std::uint64_t offset, std::uint64_t length, int target) {
        return json{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}, {"target", target}};
    };
    const auto accessor = [](int index, int component, std::uint64_t count, const char* type) {
        return json{{"bufferView", index}, {"componentType", component}, {"count", count}, {"type", type}};
    };
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
        {"materials",
         {{{"name", "bark"},
           {"pbrMetallicRoughness",
            {{"baseColorFactor", {0.32, 0.22, 0.15, 1.0}},
             {"metallicFactor", 0.0},
             {"roughnessFactor", 0.9}}}}}},
        {"accessors",
         {positions, accessor(1, kFloat, mesh.positions.size(), "VEC3"),
          accessor(2, kUnsignedInt, 3 * mesh.triangle_count(), "SCALAR")}},
        {"bufferViews",
         {view(0, sizes.vectors, kArrayBuffer), view(sizes.vectors, sizes.vectors, kArrayBuffer),
          view(2 * sizes.vectors, sizes.indices, kElementArrayBuffer)}},
        {"buffers", {{{"byteLength", sizes.total()}}}},
    };
}

void write_vectors(AtomicFile& file, std::span<const Vec3> vectors, ProgressPart part, const Context& ctx) {
    write_items(file, vectors.size(), part, ctx, [&](std::size_t v, Chunk& chunk) {
        chunk.reserve(sizeof(Vec3));
        chunk.put_raw(y_up(vectors[v]));
    });
}

}  // namespace

void write_glb(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    const Sizes sizes{mesh.positions.size() * sizeof(Vec3), mesh.triangle_count() * sizeof(Triangle)};
    std::string text = describe(mesh, sizes).dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t whole = 12 + 8 + text.size() + 8 + sizes.total();
    if (whole > std::numeric_limits<std::uint32_t>::max()) {
        throw Unsupported("a GLB file holds at most 4 GiB; write PLY or OBJ instead, or subdivide less");
    }
    const auto u32 = [](std::uint64_t value) { return static_cast<std::uint32_t>(value); };
    const auto words = [&](auto... values) {
        const std::array<std::uint32_t, sizeof...(values)> raw{values...};
        file.write(std::as_bytes(std::span(raw)));
    };
    words(0x46546C67u, 2u, u32(whole), u32(text.size()), 0x4E4F534Au);
    file.write(text);
    words(u32(sizes.total()), 0x004E4942u);
    write_vectors(file, mesh.positions, {0, 0.3f}, ctx);
    write_vectors(file, smooth_normals(mesh), {0.4f, 0.6f}, ctx);
    write_items(file, mesh.face_count, {0.6f, 1}, ctx, [&](std::size_t f, Chunk& chunk) {
        chunk.reserve(sizeof(Triangle) * (mesh.face(f).size() - 2));
        for_each_triangle(mesh, f, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            chunk.put_raw(Triangle{a, b, c});
        });
    });
}

}  // namespace coppice::io_internal
