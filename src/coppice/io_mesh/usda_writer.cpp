#include <fmt/format.h>

#include "coppice/io_mesh/copies_internal.h"
#include "coppice/io_mesh/material_internal.h"
#include "coppice/io_mesh/usda_parts_internal.h"

namespace coppice::io_internal {

void put_tuple(Chunk& chunk, TexturePoint p) {
    chunk.reserve(4 + 2 * Chunk::kNumber);
    chunk.put('(');
    chunk.put_number(p.u);
    chunk.put(", ");
    chunk.put_number(p.v);
    chunk.put(')');
}

void put_tuple(Chunk& chunk, Vec3 v) {
    chunk.reserve(8 + 3 * Chunk::kNumber);
    chunk.put('(');
    chunk.put_vector(v, ", ");
    chunk.put(')');
}

void write_head(AtomicFile& file, const MeshView& mesh, std::string_view more) {
    file.write(fmt::format(
        "#usda 1.0\n(\n    defaultPrim = \"tree\"\n{}    metersPerUnit = 1\n    upAxis = \"Z\"\n)\n\n"
        "def Xform \"tree\"\n{{\n",
        more));
    if (mesh.has_origin()) {
        file.write(
            fmt::format("    double3 xformOp:translate = ({}, {}, {})\n"
                        "    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n\n",
                        mesh.origin.x, mesh.origin.y, mesh.origin.z));
    }
    file.write(mesh.materials.empty() ? "    def Mesh \"surface\"\n    {\n"
                                      : "    def Mesh \"surface\" (\n        prepend apiSchemas = "
                                        "[\"MaterialBindingAPI\"]\n    )\n    {\n");
}

std::string extent_text(std::span<const Vec3> positions) {
    Box3 box;
    for (const Vec3 p : positions) box.extend(p);
    return fmt::format("[({}, {}, {}), ({}, {}, {})]", box.low.x, box.low.y, box.low.z, box.high.x,
                       box.high.y, box.high.z);
}

void put_weight(Chunk& chunk, TextureBlend blend) {
    chunk.reserve(Chunk::kNumber);
    chunk.put_number(blend.weight);
}

void write_texture(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    if (mesh.texture.empty()) return;
    const auto& blends = mesh.texture_blends;
    const auto write = [&](std::string_view name, const auto& put) {
        write_array(file, name, mesh.texture.size(), {1, 1}, ctx, put);
        file.write(" (\n            interpolation = \"faceVarying\"\n        )\n");
    };
    write("texCoord2f[] primvars:st",
          [&](std::size_t i, Chunk& chunk) { put_tuple(chunk, mesh.texture[i]); });
    if (blends.empty()) return;
    write("texCoord2f[] primvars:st1",
          [&](std::size_t i, Chunk& chunk) { put_tuple(chunk, blends[i].second); });
    write("float[] primvars:blend", [&](std::size_t i, Chunk& chunk) { put_weight(chunk, blends[i]); });
}

namespace {

// Writes the faces of a material as a subset of the mesh.
void write_subset(AtomicFile& file, const std::string& material, std::span<const std::uint32_t> faces,
                  const Context& ctx) {
    file.write(fmt::format(
        "        def GeomSubset \"{}\" (\n            prepend apiSchemas = [\"MaterialBindingAPI\"]\n"
        "        )\n        {{\n            uniform token elementType = \"face\"\n"
        "            uniform token familyName = \"materialBind\"\n    ",
        material));
    write_array(file, "int[] indices", faces.size(), {1, 1}, ctx, [&](std::size_t i, Chunk& chunk) {
        chunk.reserve(Chunk::kNumber);
        chunk.put_number(faces[i]);
    });
    file.write(fmt::format("\n            rel material:binding = </tree/{}>\n        }}\n", material));
}

}  // namespace

void write_tail(AtomicFile& file, const MeshView& mesh, Subdivision subdivision, const Context& ctx) {
    const bool has_subsets = !mesh.face_materials.empty();
    if (has_subsets) {
        file.write("        uniform token subsetFamily:materialBind:familyType = \"partition\"\n");
    } else if (!mesh.materials.empty()) {
        file.write(fmt::format("        rel material:binding = </tree/{}>\n", mesh.materials.front().name));
    }
    file.write(
        fmt::format("        color3f[] primvars:displayColor = [({}, {}, {})]\n"
                    "        uniform token subdivisionScheme = \"{}\"\n",
                    kPlainColor.x, kPlainColor.y, kPlainColor.z,
                    subdivision == Subdivision::none ? "none" : "catmullClark"));
    if (has_subsets) {
        const auto faces = group_by_material(mesh);
        for (std::size_t m = 0; m < faces.size(); ++m) {
            if (!faces[m].empty()) write_subset(file, mesh.materials[m].name, faces[m], ctx);
        }
    }
    file.write("    }\n");
    for (const MaterialFiles* used : list_used_materials(mesh)) file.write(usda_material(mesh.path, *used));
    if (mesh.parts != nullptr) write_usda_copies(file, mesh, ctx);
    file.write("}\n");
}

void write_usda(AtomicFile& file, const MeshView& mesh, Subdivision subdivision, const Context& ctx) {
    write_head(file, mesh);
    if (!mesh.positions.empty())
        file.write(fmt::format("        float3[] extent = {}\n", extent_text(mesh.positions)));
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
    write_texture(file, mesh, ctx);
    for (const VertexAttribute& a : mesh.attributes) {
        write_array(file, fmt::format("float[] primvars:{}", a.name), a.values.size(), {1, 1}, ctx,
                    [&](std::size_t v, Chunk& chunk) {
                        chunk.reserve(Chunk::kNumber);
                        chunk.put_number(a.values[v]);
                    });
        file.write(" (\n            interpolation = \"vertex\"\n        )\n");
    }
    write_tail(file, mesh, subdivision, ctx);
}

}  // namespace coppice::io_internal
