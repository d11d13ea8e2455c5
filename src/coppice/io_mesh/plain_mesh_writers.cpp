// OBJ and PLY.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "coppice/io_mesh/material_internal.h"
#include "coppice/io_mesh/write_internal.h"

namespace coppice::io_internal {
namespace {

template <class T>
void put_obj_vector(Chunk& chunk, std::string_view word, BasicVec3<T> p) {
    chunk.reserve(word.size() + 3 * (1 + Chunk::kNumber));
    chunk.put(word);
    chunk.put_vector(p, " ");
    chunk.put('\n');
}

std::size_t largest_face(const MeshView& mesh) {
    if (mesh.first == nullptr) return mesh.sides;
    std::size_t largest = 0;
    for (std::size_t f = 0; f < mesh.face_count; ++f) largest = std::max(largest, mesh.face(f).size());
    return largest;
}

std::string ply_header(const MeshView& mesh, std::string_view size_type) {
    const std::string_view number = mesh.has_origin() ? "double" : "float";
    // Many readers support signed indices only.
    const std::string_view index =
        mesh.positions.size() <= std::numeric_limits<std::int32_t>::max() ? "int" : "uint";
    std::string more = mesh.texture.empty() ? "" : "property float s\nproperty float t\n";
    if (!mesh.texture_blends.empty()) more += "property float s1\nproperty float t1\nproperty float blend\n";
    for (const VertexAttribute& a : mesh.attributes) more += fmt::format("property float {}\n", a.name);
    return fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment Coppice, metres, {5} up\nelement vertex {0}\n"
        "property {1} x\nproperty {1} y\nproperty {1} z\n{6}element face {2}\n"
        "property list {3} {4} vertex_indices\nend_header\n",
        mesh.positions.size(), number, mesh.face_count, size_type, index, mesh.up == FileUp::y ? 'Y' : 'Z',
        more);
}

template <class Size>
void write_ply_faces(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    write_items(file, mesh.face_count, {0.4f, 1}, ctx, [&](std::size_t f, Chunk& chunk) {
        const auto corners = mesh.face(f);
        chunk.reserve(sizeof(Size) + corners.size_bytes());
        chunk.put_raw(static_cast<Size>(corners.size()));
        chunk.put(std::string_view(reinterpret_cast<const char*>(corners.data()), corners.size_bytes()));
    });
}

// Returns whether a face has another material than the one before it.
bool begins_material(const MeshView& mesh, std::size_t f) {
    if (mesh.materials.empty()) return false;
    return f == 0 || (!mesh.face_materials.empty() && mesh.face_materials[f] != mesh.face_materials[f - 1]);
}

void put_material(Chunk& chunk, const MeshView& mesh, std::size_t f) {
    const std::string& name = mesh.materials[mesh.face_materials.empty() ? 0 : mesh.face_materials[f]].name;
    constexpr std::string_view kWord = "usemtl ";
    chunk.reserve(kWord.size() + name.size() + 1);
    chunk.put(kWord);
    chunk.put(name);
    chunk.put('\n');
}

/// Begins the group of a face if it is the first of it.
void put_group(Chunk& chunk, const MeshView& mesh, std::size_t face) {
    const auto group = std::ranges::lower_bound(mesh.groups, face, {}, &NamedGroup::first_face);
    if (group == mesh.groups.end() || group->first_face != face) return;
    const std::string text = fmt::format("g {}\n", group->name);
    chunk.reserve(text.size());
    chunk.put(text);
}

}  // namespace

void write_obj(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    file.write(mesh.up == FileUp::y ? "# Coppice, metres, Y up\n" : "# Coppice, metres, Z up\n");
    if (!mesh.materials.empty())
        file.write(fmt::format("mtllib {}\n", mtl_path(mesh.path).filename().string()));
    const bool shifted = mesh.has_origin();
    write_items(file, mesh.positions.size(), {0, 0.6f}, ctx, [&](std::size_t v, Chunk& chunk) {
        const Vec3 p = mesh.positions[v];
        shifted ? put_obj_vector(chunk, "v ", mesh.origin + Vec3d(p)) : put_obj_vector(chunk, "v ", p);
    });
    write_items(file, mesh.normals.size(), {0.6f, 0.6f}, ctx,
                [&](std::size_t v, Chunk& chunk) { put_obj_vector(chunk, "vn ", mesh.normals[v]); });
    const TextureTable texture = texture_table(mesh);
    write_items(file, texture.places.size(), {0.6f, 0.6f}, ctx, [&](std::size_t i, Chunk& chunk) {
        chunk.reserve(5 + 2 * Chunk::kNumber);
        chunk.put("vt ");
        chunk.put_number(texture.places[i].u);
        chunk.put(' ');
        chunk.put_number(texture.places[i].v);
        chunk.put('\n');
    });
    write_items(file, mesh.face_count, {0.6f, 1}, ctx, [&](std::size_t f, Chunk& chunk) {
        put_group(chunk, mesh, f);
        if (begins_material(mesh, f)) put_material(chunk, mesh, f);
        const auto corners = mesh.face(f);
        const std::size_t first = mesh.first_corner(f);
        chunk.reserve(2 + corners.size() * 3 * (1 + Chunk::kNumber));
        chunk.put('f');
        for (std::size_t k = 0; k < corners.size(); ++k) {
            chunk.put(' ');
            chunk.put_number(std::uint64_t{corners[k]} + 1);
            if (!mesh.texture.empty()) {
                chunk.put('/');
                chunk.put_number(std::uint64_t{texture.of_corner[first + k]} + 1);
            }
            if (!mesh.normals.empty()) {
                chunk.put(mesh.texture.empty() ? "//" : "/");
                chunk.put_number(std::uint64_t{corners[k]} + 1);
            }
        }
        chunk.put('\n');
    });
}

void write_ply(AtomicFile& file, const MeshView& given, const Context& ctx) {
    const std::optional<SplitMesh> split =
        given.texture.empty() ? std::nullopt : std::optional<SplitMesh>(std::in_place, given);
    const MeshView& mesh = split ? split->view : given;
    const bool small_faces = largest_face(mesh) <= std::numeric_limits<std::uint8_t>::max();
    file.write(ply_header(mesh, small_faces ? "uchar" : "uint"));
    if (mesh.has_origin() || split || !mesh.attributes.empty()) {
        write_items(file, mesh.positions.size(), {0, 0.4f}, ctx, [&](std::size_t v, Chunk& chunk) {
            chunk.reserve(sizeof(Vec3d) + sizeof(TexturePoint) + sizeof(TextureBlend) +
                          sizeof(float) * mesh.attributes.size());
            if (mesh.has_origin()) {
                chunk.put_raw(mesh.origin + Vec3d(mesh.positions[v]));
            } else {
                chunk.put_raw(mesh.positions[v]);
            }
            if (split) chunk.put_raw(split->table.places[v]);
            if (split && !split->table.blends.empty()) chunk.put_raw(split->table.blends[v]);
            for (const VertexAttribute& a : mesh.attributes)
                chunk.put_raw(a.values[SplitMesh::original(split, v)]);
        });
    } else {
        file.write(std::as_bytes(mesh.positions));
    }
    small_faces ? write_ply_faces<std::uint8_t>(file, mesh, ctx)
                : write_ply_faces<std::uint32_t>(file, mesh, ctx);
}

}  // namespace coppice::io_internal
