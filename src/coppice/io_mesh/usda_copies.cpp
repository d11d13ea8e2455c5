#include <fmt/format.h>

#include <cmath>

#include "coppice/io_mesh/copies_internal.h"
#include "coppice/io_mesh/material_internal.h"
#include "coppice/io_mesh/usda_parts_internal.h"

namespace coppice::io_internal {
namespace {

constexpr ProgressRange kEnd{1, 1};
constexpr std::string_view kScope = "/tree/leaves";

/// Rounds to the precision of the half-precision floats and bytes from which the values are made.
float rounded(float x) { return std::round(x * 1e4f) / 1e4f; }

void put_rotation(Chunk& chunk, Quaternion r) {
    chunk.reserve(16 + 4 * Chunk::kNumber);
    chunk.put('(');
    chunk.put_number(rounded(r.w));
    chunk.put(", ");
    chunk.put_vector(Vec3{rounded(r.x), rounded(r.y), rounded(r.z)}, ", ");
    chunk.put(')');
}

void put_color(Chunk& chunk, std::array<std::uint8_t, 3> srgb) {
    const Vec3 c = compute_linear_color(srgb);
    put_tuple(chunk, Vec3{rounded(c.x), rounded(c.y), rounded(c.z)});
}

void write_extent(AtomicFile& file, const Box3& box) {
    const std::array<Vec3, 2> corners{box.low, box.high};
    file.write(fmt::format("        float3[] extent = {}\n", extent_text(corners)));
}

/// Writes the attributes of a mesh of copies and its binding; the prim is named by the prototype.
void write_copy_mesh(AtomicFile& file, const CopyMesh& mesh, const MaterialFiles& material,
                     const Context& ctx) {
    const std::size_t n = mesh.vertex_count();
    file.write(
        fmt::format("        def Mesh \"{}\" (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n"
                    "        )\n        {{\n",
                    mesh.prototype().name));
    write_extent(file, mesh.find_box(ctx, [](Vec3 p) { return p; }));
    write_array(file, "int[] faceVertexCounts", mesh.triangle_count(), kEnd, ctx,
                [&](std::size_t, Chunk& chunk) { chunk.put('3'); });
    file.write("\n");
    write_array(file, "int[] faceVertexIndices", mesh.triangle_count(), kEnd, ctx,
                [&](std::size_t f, Chunk& chunk) {
                    const Triangle t = mesh.triangle(f);
                    chunk.reserve(8 + 3 * Chunk::kNumber);
                    chunk.put_number(t[0]);
                    for (const std::size_t k : {1u, 2u}) {
                        chunk.put(", ");
                        chunk.put_number(t[k]);
                    }
                });
    file.write("\n");
    write_array(file, "point3f[] points", n, kEnd, ctx,
                [&](std::size_t v, Chunk& chunk) { put_tuple(chunk, mesh.position(v)); });
    file.write("\n");
    const auto write_primvar = [&](std::string_view name, const auto& put) {
        write_array(file, name, n, kEnd, ctx, put);
        file.write(" (\n            interpolation = \"vertex\"\n        )\n");
    };
    write_primvar("normal3f[] normals",
                  [&](std::size_t v, Chunk& chunk) { put_tuple(chunk, mesh.normal(v)); });
    if (mesh.has_texture())
        write_primvar("texCoord2f[] primvars:st",
                      [&](std::size_t v, Chunk& chunk) { put_tuple(chunk, mesh.texture(v)); });
    if (mesh.is_merged())
        write_primvar("color3f[] primvars:displayColor",
                      [&](std::size_t v, Chunk& chunk) { put_color(chunk, mesh.color(v)); });
    file.write(
        fmt::format("        uniform bool doubleSided = {}\n        rel material:binding = <{}/{}>\n"
                    "        uniform token subdivisionScheme = \"none\"\n        }}\n",
                    material.double_sided ? 1 : 0, kScope, material.name));
}

/// Writes the arrays of the copies, in their order.
void write_places(AtomicFile& file, const Instances& of, std::span<const std::uint32_t> number,
                  const Context& ctx) {
    const auto write = [&](std::string_view name, const auto& put) {
        write_array(file, name, of.size(), kEnd, ctx, put);
        file.write("\n");
    };
    write("int[] protoIndices", [&](std::size_t i, Chunk& chunk) {
        chunk.reserve(Chunk::kNumber);
        chunk.put_number(number[of.prototypes[i]]);
    });
    write("point3f[] positions", [&](std::size_t i, Chunk& chunk) { put_tuple(chunk, of.positions[i]); });
    write("quath[] orientations", [&](std::size_t i, Chunk& chunk) { put_rotation(chunk, of.rotations[i]); });
    write("float3[] scales", [&](std::size_t i, Chunk& chunk) {
        put_tuple(chunk, Vec3{of.scales[i], of.scales[i], of.scales[i]});
    });
    write_array(file, "color3f[] primvars:displayColor", of.size(), kEnd, ctx,
                [&](std::size_t i, Chunk& chunk) { put_color(chunk, of.colors[i]); });
    file.write(" (\n            interpolation = \"varying\"\n        )\n");
}

/// Writes the attributes of the point instancer except the prototypes themselves.
void write_instancer(AtomicFile& file, const InstancedParts& parts, const CopyMeshes& meshes,
                     const Context& ctx) {
    std::vector<std::uint32_t> number(parts.prototypes.size());
    std::string targets;
    std::uint32_t used = 0;
    for (std::size_t p = 0; p < number.size(); ++p) {
        if (meshes.copies[p].empty()) continue;
        number[p] = used++;
        targets += fmt::format("{}<{}/prototypes/{}>", targets.empty() ? "" : ", ", kScope,
                               parts.prototypes[p].name);
    }
    write_extent(file, compute_bounds(parts.prototypes, *parts.instances, ctx));
    file.write(fmt::format("        rel prototypes = [{}]\n", targets));
    write_places(file, *parts.instances, number, ctx);
}

}  // namespace

void write_usda_copies(AtomicFile& file, const MeshView& surface, const Context& ctx) {
    const InstancedParts& parts = *surface.parts;
    const bool is_merged = parts.storage == InstanceStorage::merged;
    const CopyMeshes meshes(parts, false, ctx);
    file.write(fmt::format("    def {} \"leaves\"\n    {{\n", is_merged ? "Xform" : "PointInstancer"));
    const Vec3d shift = parts.instances->origin - surface.origin;
    if (shift != Vec3d{}) {
        file.write(
            fmt::format("        double3 xformOp:translate = ({}, {}, {})\n"
                        "        uniform token[] xformOpOrder = [\"xformOp:translate\"]\n",
                        shift.x, shift.y, shift.z));
    }
    if (!is_merged) {
        write_instancer(file, parts, meshes, ctx);
        file.write("        def Scope \"prototypes\"\n        {\n");
    }
    for (const CopyMesh& mesh : meshes.meshes)
        write_copy_mesh(file, mesh, parts.materials[mesh.prototype().material], ctx);
    if (!is_merged) file.write("        }\n");
    for (const MaterialFiles& material : parts.materials)
        file.write(usda_material(surface.path, material, kScope));
    file.write("    }\n");
}

}  // namespace coppice::io_internal
