// OBJ and PLY.

#include <fmt/format.h>

#include <array>
#include <limits>

#include "coppice/io/mesh/write_internal.h"

namespace coppice::io_internal {
namespace {

template <class T>
void put_obj_vertex(Chunk& chunk, BasicVec3<T> p) {
    chunk.reserve(2 + 3 * (1 + Chunk::kNumber));
    chunk.put("v ");
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
    // Many readers know signed indices only.
    const std::string_view index =
        mesh.positions.size() <= std::numeric_limits<std::int32_t>::max() ? "int" : "uint";
    return fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment Coppice, metres, Z up\nelement vertex {0}\n"
        "property {1} x\nproperty {1} y\nproperty {1} z\nelement face {2}\n"
        "property list {3} {4} vertex_indices\nend_header\n",
        mesh.positions.size(), number, mesh.face_count, size_type, index);
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

}  // namespace

void write_obj(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    file.write("# Coppice, metres, Z up\n");
    const bool shifted = mesh.has_origin();
    write_items(file, mesh.positions.size(), {0, 0.6f}, ctx, [&](std::size_t v, Chunk& chunk) {
        const Vec3 p = mesh.positions[v];
        shifted ? put_obj_vertex(chunk, mesh.origin + Vec3d(p)) : put_obj_vertex(chunk, p);
    });
    write_items(file, mesh.face_count, {0.6f, 1}, ctx, [&](std::size_t f, Chunk& chunk) {
        const auto corners = mesh.face(f);
        chunk.reserve(2 + corners.size() * (1 + Chunk::kNumber));
        chunk.put('f');
        for (const std::uint32_t v : corners) {
            chunk.put(' ');
            chunk.put_number(std::uint64_t{v} + 1);
        }
        chunk.put('\n');
    });
}

void write_ply(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    const bool small_faces = largest_face(mesh) <= std::numeric_limits<std::uint8_t>::max();
    file.write(ply_header(mesh, small_faces ? "uchar" : "uint"));
    if (mesh.has_origin()) {
        write_items(file, mesh.positions.size(), {0, 0.4f}, ctx, [&](std::size_t v, Chunk& chunk) {
            chunk.reserve(sizeof(Vec3d));
            chunk.put_raw(mesh.origin + Vec3d(mesh.positions[v]));
        });
    } else {
        file.write(std::as_bytes(mesh.positions));
    }
    small_faces ? write_ply_faces<std::uint8_t>(file, mesh, ctx)
                : write_ply_faces<std::uint32_t>(file, mesh, ctx);
}

}  // namespace coppice::io_internal
