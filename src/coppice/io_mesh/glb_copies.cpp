#include "coppice/io_mesh/glb_copies_internal.h"

#include <cmath>
#include <map>

namespace coppice::io_internal {
namespace {

using nlohmann::json;

constexpr int kUnsignedByte = 5121;
constexpr int kShort = 5122;
constexpr std::array<std::uint8_t, 3> kWhite{255, 255, 255};

std::int16_t to_short(float x) { return static_cast<std::int16_t>(std::lround(32767 * x)); }

/// Returns the colour of a copy as linear bytes; alpha keeps elements at multiples of four bytes.
std::array<std::uint8_t, 4> to_bytes(std::array<std::uint8_t, 3> srgb) {
    const Vec3 c = compute_linear_color(srgb);
    const auto byte = [](float x) { return static_cast<std::uint8_t>(std::lround(255 * x)); };
    return {byte(c.x), byte(c.y), byte(c.z), 255};
}

/// Rotates in the frame of the file, in which y is up.
std::array<std::int16_t, 4> to_shorts(Quaternion r) {
    const Vec3 axis = y_up(Vec3{r.x, r.y, r.z});
    return {to_short(axis.x), to_short(axis.y), to_short(axis.z), to_short(r.w)};
}

std::size_t add_normalized(GlbLayout& layout, std::uint64_t size, int target, int component,
                           std::uint64_t count) {
    const std::size_t index = layout.add(count * size, target, component, count, "VEC4");
    layout[index]["normalized"] = true;
    return index;
}

/// Writes one value for each item.
template <class Get>
void write_values(AtomicFile& file, std::size_t count, const Context& ctx, const Get& get) {
    write_items(file, count, {1, 1}, ctx, [&](std::size_t i, Chunk& chunk) {
        const auto value = get(i);
        chunk.reserve(sizeof value);
        chunk.put_raw(value);
    });
}

}  // namespace

GlbCopies::Varied GlbCopies::find_varied(const CopyMesh& mesh) const {
    Varied out;
    for (const std::uint32_t copy : mesh.copies()) {
        out.scales = out.scales || instances_.scales[copy] != 1;
        out.colors = out.colors || instances_.colors[copy] != kWhite;
    }
    return out;
}

GlbCopies::Accessors GlbCopies::lay_out(const CopyMesh& mesh, GlbLayout& layout) const {
    Accessors out{{}, {}, 0, find_varied(mesh)};
    const std::size_t n = mesh.vertex_count(), copies = mesh.copies().size();
    const auto add = [&](std::size_t size, const char* type) {
        return layout.add(n * size, kArrayBuffer, kFloat, n, type);
    };
    const std::size_t position = layout.add_vectors(n);
    const Box3 box = mesh.find_box(ctx_, [](Vec3 p) { return y_up(p); });
    layout[position]["min"] = to_json_array(Vec3d(box.low));
    layout[position]["max"] = to_json_array(Vec3d(box.high));
    out.attributes = {{"POSITION", position}, {"NORMAL", layout.add_vectors(n)}};
    if (mesh.has_texture()) out.attributes["TEXCOORD_0"] = add(sizeof(TexturePoint), "VEC2");
    if (mesh.has_tangents()) out.attributes["TANGENT"] = add(sizeof(Tangent), "VEC4");
    const bool has_vertex_colors = mesh.is_merged() && out.varied.colors;
    if (has_vertex_colors)
        out.attributes["COLOR_0"] = add_normalized(layout, 4, kArrayBuffer, kUnsignedByte, n);
    const std::size_t corners = 3 * mesh.triangle_count();
    out.indices =
        layout.add(corners * sizeof(std::uint32_t), kElementArrayBuffer, kUnsignedInt, corners, "SCALAR");
    if (mesh.is_merged()) return out;
    const auto add_vectors = [&] { return layout.add(copies * sizeof(Vec3), 0, kFloat, copies, "VEC3"); };
    out.instancing["TRANSLATION"] = add_vectors();
    out.instancing["ROTATION"] = add_normalized(layout, 8, 0, kShort, copies);
    if (out.varied.scales) out.instancing["SCALE"] = add_vectors();
    if (out.varied.colors) out.instancing["_COLOR_0"] = add_normalized(layout, 4, 0, kUnsignedByte, copies);
    return out;
}

void GlbCopies::lay_out(const GlbVertices&, json&, GlbLayout& layout) {
    for (const CopyMesh& mesh : meshes_.meshes) accessors_.push_back(lay_out(mesh, layout));
    for (const MaterialFiles& material : parts_.materials) materials_.add(material, layout);
}

void GlbCopies::describe(json& file) const {
    constexpr int kTriangles = 4;
    const std::size_t first_material = materials_.describe(file);
    for (std::size_t m = 0; m < accessors_.size(); ++m) {
        const Prototype& prototype = meshes_.meshes[m].prototype();
        json node{{"name", prototype.name}, {"mesh", file["meshes"].size()}};
        if (instances_.origin != Vec3d{}) node["translation"] = to_json_array(y_up(instances_.origin));
        if (!accessors_[m].instancing.is_null())
            node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = accessors_[m].instancing;
        const json primitive{{"attributes", accessors_[m].attributes},
                             {"indices", accessors_[m].indices},
                             {"material", first_material + prototype.material},
                             {"mode", kTriangles}};
        file["scenes"][0]["nodes"].push_back(file["nodes"].size());
        file["nodes"].push_back(std::move(node));
        file["meshes"].push_back({{"name", prototype.name}, {"primitives", json::array({primitive})}});
    }
    // Not in extensionsRequired: programs without it then show the tree with one copy of each prototype.
    if (parts_.storage == InstanceStorage::instanced)
        file["extensionsUsed"] = json::array({"EXT_mesh_gpu_instancing"});
}

void GlbCopies::write(AtomicFile& file, const GlbVertices&, const Context& ctx) {
    for (std::size_t m = 0; m < accessors_.size(); ++m) {
        const CopyMesh& mesh = meshes_.meshes[m];
        write_mesh(file, mesh, ctx);
        if (mesh.is_merged() && accessors_[m].varied.colors)
            write_values(file, mesh.vertex_count(), ctx,
                         [&](std::size_t v) { return to_bytes(mesh.color(v)); });
        write_values(file, mesh.triangle_count(), ctx, [&](std::size_t f) { return mesh.triangle(f); });
        if (!mesh.is_merged()) write_copies(file, mesh, accessors_[m].varied, ctx);
    }
    materials_.write(file);
}

void GlbCopies::write_mesh(AtomicFile& file, const CopyMesh& mesh, const Context& ctx) const {
    const std::size_t n = mesh.vertex_count();
    write_values(file, n, ctx, [&](std::size_t v) { return y_up(mesh.position(v)); });
    write_values(file, n, ctx, [&](std::size_t v) { return y_up(mesh.normal(v)); });
    if (mesh.has_texture()) {
        write_values(file, n, ctx, [&](std::size_t v) {
            const TexturePoint t = mesh.texture(v);
            return TexturePoint{t.u, 1 - t.v};  // in glTF, v points down in the image
        });
    }
    if (mesh.has_tangents()) {
        write_values(file, n, ctx, [&](std::size_t v) {
            const Tangent t = mesh.tangent(v);
            return Tangent{y_up(t.direction), t.sign};
        });
    }
}

void GlbCopies::write_copies(AtomicFile& file, const CopyMesh& mesh, Varied varied,
                             const Context& ctx) const {
    const auto copies = mesh.copies();
    const auto write = [&](const auto& get) {
        write_values(file, copies.size(), ctx, [&](std::size_t i) { return get(copies[i]); });
    };
    write([&](std::uint32_t copy) { return y_up(instances_.positions[copy]); });
    write([&](std::uint32_t copy) { return to_shorts(instances_.rotations[copy]); });
    if (varied.scales) {
        write([&](std::uint32_t copy) {
            const float s = instances_.scales[copy];
            return Vec3{s, s, s};
        });
    }
    if (varied.colors) write([&](std::uint32_t copy) { return to_bytes(instances_.colors[copy]); });
}

}  // namespace coppice::io_internal
