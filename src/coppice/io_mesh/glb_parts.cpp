#include <array>
#include <limits>
#include <utility>

#include "coppice/io_mesh/glb_parts_internal.h"

namespace coppice::io_internal {

using nlohmann::json;

std::size_t GlbLayout::add(std::uint64_t bytes, int target, int component, std::uint64_t count,
                           const char* type) {
    json view{{"buffer", 0}, {"byteOffset", bytes_}, {"byteLength", bytes}};
    if (target != 0) view["target"] = target;
    accessors_.push_back(
        {{"bufferView", views_.size()}, {"componentType", component}, {"count", count}, {"type", type}});
    views_.push_back(std::move(view));
    bytes_ += bytes;
    return accessors_.size() - 1;
}

std::size_t GlbLayout::add_vectors(std::uint64_t count) {
    return add(count * sizeof(Vec3), kArrayBuffer, kFloat, count, "VEC3");
}

std::size_t GlbLayout::add_vectors(std::span<const Vec3> bounded) {
    const std::size_t index = add_vectors(bounded.size());
    Box3 box;
    for (const Vec3 v : bounded) box.extend(y_up(v));
    accessors_[index]["min"] = to_json_array(Vec3d(box.low));
    accessors_[index]["max"] = to_json_array(Vec3d(box.high));
    return index;
}

std::size_t GlbLayout::add_bytes(std::uint64_t bytes) {
    views_.push_back({{"buffer", 0}, {"byteOffset", bytes_}, {"byteLength", bytes}});
    bytes_ += (bytes + 3) / 4 * 4;
    return views_.size() - 1;
}

json describe_tree(const MeshView& mesh, json primitives, GlbLayout& layout) {
    constexpr int kTriangles = 4;
    json node{{"name", "tree"}, {"mesh", 0}};
    if (mesh.has_origin()) node["translation"] = to_json_array(y_up(mesh.origin));
    for (json& primitive : primitives) primitive["mode"] = kTriangles;
    const json plain{{"name", "bark"},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {kPlainColor.x, kPlainColor.y, kPlainColor.z, 1.0}},
                       {"metallicFactor", 0.0},
                       {"roughnessFactor", 0.9}}}};
    return {
        {"asset", {{"version", "2.0"}, {"generator", "Coppice"}}},
        {"scene", 0},
        {"scenes", {{{"nodes", {0}}}}},
        {"nodes", json::array({std::move(node)})},
        {"meshes", {{{"name", "surface"}, {"primitives", std::move(primitives)}}}},
        {"materials", json::array({plain})},
        {"accessors", layout.accessors()},
        {"bufferViews", layout.views()},
        {"buffers", {{{"byteLength", layout.bytes()}}}},
    };
}

void write_glb_head(AtomicFile& file, std::string text, std::uint64_t buffer_bytes) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t whole = 12 + 8 + text.size() + 8 + buffer_bytes;
    if (whole > std::numeric_limits<std::uint32_t>::max()) {
        throw Unsupported("a GLB file contains at most 4 GiB; write PLY or OBJ instead, or subdivide less");
    }
    const auto u32 = [](std::uint64_t value) { return static_cast<std::uint32_t>(value); };
    const auto words = [&](auto... values) {
        const std::array<std::uint32_t, sizeof...(values)> raw{values...};
        file.write(std::as_bytes(std::span(raw)));
    };
    words(0x46546C67u, 2u, u32(whole), u32(text.size()), 0x4E4F534Au);
    file.write(text);
    words(u32(buffer_bytes), 0x004E4942u);
}

void write_vectors(AtomicFile& file, std::span<const Vec3> vectors, ProgressRange part, const Context& ctx) {
    write_items(file, vectors.size(), part, ctx, [&](std::size_t v, Chunk& chunk) {
        chunk.reserve(sizeof(Vec3));
        chunk.put_raw(y_up(vectors[v]));
    });
}

namespace {

void put_triangles(Chunk& chunk, const MeshView& mesh, std::size_t f) {
    chunk.reserve(sizeof(Triangle) * (mesh.face(f).size() - 2));
    for_each_triangle(mesh, f, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        chunk.put_raw(Triangle{a, b, c});
    });
}

}  // namespace

void write_triangles(AtomicFile& file, const MeshView& mesh, ProgressRange part, const Context& ctx) {
    write_items(file, mesh.face_count, part, ctx,
                [&](std::size_t f, Chunk& chunk) { put_triangles(chunk, mesh, f); });
}

void write_triangles(AtomicFile& file, const MeshView& mesh, std::span<const std::uint32_t> faces,
                     ProgressRange part, const Context& ctx) {
    write_items(file, faces.size(), part, ctx,
                [&](std::size_t i, Chunk& chunk) { put_triangles(chunk, mesh, faces[i]); });
}

}  // namespace coppice::io_internal
