// GLB is written without tinygltf: that library stores the whole file in one vector and copies it into a
// second stream before writing the first byte, which for some hundred megabytes costs more than the rest of
// the export.

#include <algorithm>
#include <optional>
#include <utility>

#include "coppice/base/progress.h"
#include "coppice/io_mesh/glb_copies_internal.h"
#include "coppice/io_mesh/glb_materials_internal.h"
#include "coppice/io_mesh/glb_names_internal.h"
#include "coppice/io_mesh/material_internal.h"

namespace coppice::io_internal {
namespace {

using nlohmann::json;

// In glTF, v points down in the image.
void write_texture(AtomicFile& file, std::span<const TexturePoint> places, const Context& ctx) {
    write_items(file, places.size(), {0.6f, 0.7f}, ctx, [&](std::size_t v, Chunk& chunk) {
        chunk.reserve(sizeof(TexturePoint));
        chunk.put_raw(TexturePoint{places[v].u, 1 - places[v].v});
    });
}

void write_blends(AtomicFile& file, std::span<const TextureBlend> blends, const Context& ctx) {
    write_items(file, blends.size(), {0.7f, 0.7f}, ctx, [&](std::size_t v, Chunk& chunk) {
        chunk.reserve(sizeof(TexturePoint));
        chunk.put_raw(TexturePoint{blends[v].second.u, 1 - blends[v].second.v});
    });
    write_items(file, blends.size(), {0.7f, 0.7f}, ctx, [&](std::size_t v, Chunk& chunk) {
        chunk.reserve(sizeof(float));
        chunk.put_raw(blends[v].weight);
    });
}

// Returns coordinates that differ only if they do in the file: where they do not, readers see one vertex.
TexturePoint round_point(TexturePoint t) { return {t.u, 1 - (1 - t.v)}; }

std::vector<TexturePoint> round_texture(std::span<const TexturePoint> texture) {
    std::vector<TexturePoint> out;
    out.reserve(texture.size());
    for (const TexturePoint t : texture) out.push_back(round_point(t));
    return out;
}

std::vector<TextureBlend> round_blends(std::span<const TextureBlend> blends) {
    std::vector<TextureBlend> out;
    out.reserve(blends.size());
    for (const TextureBlend& b : blends) out.push_back({round_point(b.second), b.weight});
    return out;
}

void write_tangents(AtomicFile& file, std::span<const Tangent> tangents, const Context& ctx) {
    write_items(file, tangents.size(), {0.7f, 0.7f}, ctx, [&](std::size_t v, Chunk& chunk) {
        chunk.reserve(sizeof(Tangent));
        chunk.put_raw(Tangent{y_up(tangents[v].direction), tangents[v].sign});
    });
}

void write_attribute(AtomicFile& file, const VertexAttribute& attribute,
                     const std::optional<SplitMesh>& split, std::size_t count, const Context& ctx) {
    write_items(file, count, {0.7f, 0.7f}, ctx, [&](std::size_t v, Chunk& chunk) {
        chunk.reserve(sizeof(float));
        chunk.put_raw(attribute.values[SplitMesh::original(split, v)]);
    });
}

}  // namespace

void split_mesh(const MeshView& given, bool for_tangents, std::optional<SplitMesh>& out, const Context& ctx) {
    if (for_tangents) {
        const std::vector<TexturePoint> texture = round_texture(given.texture);
        const std::vector<TextureBlend> blends = round_blends(given.texture_blends);
        MeshView rounded = given;
        rounded.texture = texture;
        rounded.texture_blends = blends;
        out.emplace(rounded);
        out->divide_for_tangents(ctx);
    } else if (!given.texture.empty()) {
        out.emplace(given);
    }
}

namespace {

// Lays out the attributes of the vertices, in the order in which they are written.
json describe_attributes(const MeshView& mesh, const std::optional<SplitMesh>& split, bool has_tangents,
                         GlbLayout& layout) {
    const std::size_t count = mesh.positions.size();
    const auto add = [&](std::size_t size, const char* type) {
        return layout.add(count * size, kArrayBuffer, kFloat, count, type);
    };
    json out{{"POSITION", layout.add_vectors(mesh.positions)}, {"NORMAL", layout.add_vectors(count)}};
    if (split) out["TEXCOORD_0"] = add(sizeof(TexturePoint), "VEC2");
    if (has_tangents) out["TANGENT"] = add(sizeof(Tangent), "VEC4");
    if (split && !split->table.blends.empty()) {
        out["TEXCOORD_1"] = add(sizeof(TexturePoint), "VEC2");
        out["_BLEND"] = add(sizeof(float), "SCALAR");
    }
    for (const VertexAttribute& a : mesh.attributes)
        out[glb_attribute_name(a.name)] = add(sizeof(float), "SCALAR");
    return out;
}

// The faces of a primitive.
struct FaceGroup {
    std::span<const std::uint32_t> faces;  // empty: all
    std::uint64_t corners = 0;             // of their triangles
};

// Returns the faces of each material that some have; `by_material` are those of all materials.
std::vector<FaceGroup> list_groups(const MeshView& mesh, const CompressedRows<std::uint32_t>& by_material) {
    if (mesh.face_materials.empty()) return {{{}, 3 * mesh.triangle_count()}};
    std::vector<FaceGroup> out;
    for (std::size_t m = 0; m < by_material.size(); ++m) {
        if (by_material[m].empty()) continue;
        FaceGroup group{by_material[m]};
        for (const std::uint32_t f : group.faces) group.corners += 3 * (mesh.face(f).size() - 2);
        out.push_back(group);
    }
    return out;
}

void write_groups(AtomicFile& file, const MeshView& mesh, std::span<const FaceGroup> groups,
                  const Context& ctx) {
    const auto total = 3 * static_cast<float>(mesh.triangle_count());
    float done = 0.7f;
    for (const FaceGroup& group : groups) {
        const float begin = done;
        done += 0.3f * static_cast<float>(group.corners) / total;
        if (group.faces.empty()) {
            write_triangles(file, mesh, {begin, done}, ctx);
        } else {
            write_triangles(file, mesh, group.faces, {begin, done}, ctx);
        }
    }
}

// Returns a primitive with the indices of each group and its material, with everything else in common.
json describe_primitives(json common, std::span<const std::size_t> indices) {
    json out = json::array();
    for (const std::size_t accessor : indices) {
        common["material"] = out.size();
        common["indices"] = accessor;
        out.push_back(common);
    }
    return out;
}

}  // namespace

void write_glb(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    std::optional<GlbCopies> copies;
    if (mesh.parts != nullptr) copies.emplace(*mesh.parts, ctx);
    write_glb(file, mesh, copies ? &*copies : nullptr, ctx);
}

void write_glb(AtomicFile& file, const MeshView& given, GlbMotionPart* motion, const Context& whole) {
    constexpr float kShareOfRest = 0.15f;
    const Context ctx = narrow_progress(whole, 0, motion != nullptr ? kShareOfRest : 1);
    const std::vector<const MaterialFiles*> used = list_used_materials(given);
    const bool has_tangents =
        std::ranges::any_of(used, [](const MaterialFiles* m) { return !m->normal.empty(); });
    std::optional<SplitMesh> split;
    split_mesh(given, has_tangents, split, ctx);
    const MeshView& mesh = split ? split->view : given;
    std::vector<Vec3> normals = smooth_normals(given);
    if (split) normals = split_vectors(normals, *split);
    const std::vector<Tangent> tangents =
        has_tangents ? compute_tangents(*split, normals, ctx) : std::vector<Tangent>();
    GlbLayout layout;
    const json attributes = describe_attributes(mesh, split, has_tangents, layout);
    const CompressedRows<std::uint32_t> by_material = group_by_material(mesh);
    const std::vector<FaceGroup> groups = list_groups(mesh, by_material);
    std::vector<std::size_t> indices;
    for (const FaceGroup& group : groups) {
        indices.push_back(layout.add(group.corners * sizeof(std::uint32_t), kElementArrayBuffer, kUnsignedInt,
                                     group.corners, "SCALAR"));
    }
    json primitive{{"attributes", attributes}};
    const GlbVertices vertices{given, split, normals, tangents};
    if (motion != nullptr) motion->lay_out(vertices, primitive, layout);
    GlbMaterials materials;
    for (const MaterialFiles* m : used) materials.add(*m, layout);
    json text = describe_tree(mesh, describe_primitives(std::move(primitive), indices), layout);
    if (!used.empty()) {
        text["materials"] = json::array();  // in place of the plain one
        materials.describe(text);
    }
    if (motion != nullptr) motion->describe(text);
    write_glb_head(file, text.dump(), layout.bytes());
    write_vectors(file, mesh.positions, {0, 0.3f}, ctx);
    write_vectors(file, normals, {0.4f, 0.6f}, ctx);
    if (split) write_texture(file, split->table.places, ctx);
    write_tangents(file, tangents, ctx);
    if (split) write_blends(file, split->table.blends, ctx);
    for (const VertexAttribute& a : mesh.attributes)
        write_attribute(file, a, split, mesh.positions.size(), ctx);
    write_groups(file, mesh, groups, ctx);
    if (motion != nullptr) motion->write(file, vertices, narrow_progress(whole, kShareOfRest, 1));
    materials.write(file);
}

}  // namespace coppice::io_internal
