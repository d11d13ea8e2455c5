// OBJ, PLY and STL.

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

/// STL has 32-bit numbers and nowhere to put an origin: refuses what rounding would visibly damage.
void check_stl_rounding(const MeshView& mesh) {
    if (!mesh.has_origin()) return;
    Box3 box;
    for (const Vec3 p : mesh.positions) box.extend(p);
    const double reach = length(mesh.origin) + box.diagonal();
    if (reach * std::numeric_limits<float>::epsilon() > 1e-5 * box.diagonal()) {
        throw Unsupported(
            "STL has too few digits for coordinates that far from zero; write PLY or OBJ instead");
    }
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

void write_stl(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    if (mesh.triangle_count() > std::numeric_limits<std::uint32_t>::max()) {
        throw Unsupported("STL holds at most 4294967295 triangles; write PLY or OBJ instead");
    }
    check_stl_rounding(mesh);
    Chunk head;
    head.reserve(84);
    head.put(fmt::format("{:<80}", "Coppice, metres, Z up"));
    head.put_raw(static_cast<std::uint32_t>(mesh.triangle_count()));
    file.write(head.view());
    const auto place = [&](std::uint32_t v) { return Vec3(mesh.origin + Vec3d(mesh.positions[v])); };
    write_items(file, mesh.face_count, {}, ctx, [&](std::size_t f, Chunk& chunk) {
        chunk.reserve(50 * (mesh.face(f).size() - 2));
        for_each_triangle(mesh, f, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            const std::array<Vec3, 3> p{place(a), place(b), place(c)};
            chunk.put_raw(normalized(cross(p[1] - p[0], p[2] - p[0]), {}));
            chunk.put_raw(p);
            chunk.put_raw(std::uint16_t{0});
        });
    });
}

}  // namespace coppice::io_internal
