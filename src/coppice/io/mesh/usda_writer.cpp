#include <fmt/format.h>

#include "coppice/io/mesh/write_internal.h"

namespace coppice::io_internal {
namespace {

/// name = [item, item, ...] with a line break now and then, which USD's parser allows and editors need.
template <class Put>
void write_array(AtomicFile& file, std::string_view name, std::size_t count, ProgressPart part,
                 const Context& ctx, const Put& put) {
    file.write(fmt::format("        {} = [", name));
    write_items(file, count, part, ctx, [&](std::size_t i, Chunk& chunk) {
        chunk.reserve(16);
        chunk.put(i == 0 ? "" : i % 8 == 0 ? ",\n            " : ", ");
        put(i, chunk);
    });
    file.write("]");
}

void put_tuple(Chunk& chunk, Vec3 v) {
    chunk.reserve(8 + 3 * Chunk::kNumber);
    chunk.put('(');
    chunk.put_vector(v, ", ");
    chunk.put(')');
}

void put_tuple(Chunk& chunk, TexturePoint p) {
    chunk.reserve(4 + 2 * Chunk::kNumber);
    chunk.put('(');
    chunk.put_number(p.u);
    chunk.put(", ");
    chunk.put_number(p.v);
    chunk.put(')');
}

void write_head(AtomicFile& file, const MeshView& mesh) {
    file.write(
        "#usda 1.0\n(\n    defaultPrim = \"tree\"\n    metersPerUnit = 1\n    upAxis = \"Z\"\n)\n\n"
        "def Xform \"tree\"\n{\n");
    if (mesh.has_origin()) {
        file.write(
            fmt::format("    double3 xformOp:translate = ({}, {}, {})\n"
                        "    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n\n",
                        mesh.origin.x, mesh.origin.y, mesh.origin.z));
    }
    file.write("    def Mesh \"surface\"\n    {\n");
}

void write_extent(AtomicFile& file, const MeshView& mesh) {
    if (mesh.positions.empty()) return;
    Box3 box;
    for (const Vec3 p : mesh.positions) box.extend(p);
    file.write(fmt::format("        float3[] extent = [({}, {}, {}), ({}, {}, {})]\n", box.low.x, box.low.y,
                           box.low.z, box.high.x, box.high.y, box.high.z));
}

}  // namespace

void write_usda(AtomicFile& file, const MeshView& mesh, Subdivision subdivision, const Context& ctx) {
    write_head(file, mesh);
    write_extent(file, mesh);
    write_array(file, "int[] faceVertexCounts", mesh.face_count, {0, 0.1f}, ctx,
                [&](std::size_t f, Chunk& chunk) {
                    chunk.reserve(Chunk::kNumber);
                    chunk.put_number(mesh.face(f).size());
                });
    file.write("\n");
    write_array(file, "int[] faceVertexIndices", mesh.first_corner(mesh.face_count), {0.1f, 0.4f}, ctx,
                [&](std::size_t i, Chunk& chunk) {
                    chunk.reserve(Chunk::kNumber);
                    chunk.put_number(mesh.corners[i]);
                });
    file.write("\n");
    write_array(file, "point3f[] points", mesh.positions.size(), {0.4f, 0.7f}, ctx,
                [&](std::size_t v, Chunk& chunk) { put_tuple(chunk, mesh.positions[v]); });
    file.write("\n");
    if (subdivision == Subdivision::none) {
        const auto normals = smooth_normals(mesh);
        write_array(file, "normal3f[] normals", normals.size(), {0.7f, 1}, ctx,
                    [&](std::size_t v, Chunk& chunk) { put_tuple(chunk, normals[v]); });
        file.write(" (\n            interpolation = \"vertex\"\n        )\n");
    }
    if (!mesh.texture.empty()) {
        write_array(file, "texCoord2f[] primvars:st", mesh.texture.size(), {1, 1}, ctx,
                    [&](std::size_t i, Chunk& chunk) { put_tuple(chunk, mesh.texture[i]); });
        file.write(" (\n            interpolation = \"faceVarying\"\n        )\n");
    }
    file.write("        color3f[] primvars:displayColor = [(0.32, 0.22, 0.15)]\n");
    file.write(fmt::format("        uniform token subdivisionScheme = \"{}\"\n    }}\n}}\n",
                           subdivision == Subdivision::none ? "none" : "catmullClark"));
}

}  // namespace coppice::io_internal
