// GLB is written without tinygltf: that library stores the whole file in one vector and copies it into a
// second stream before writing the first byte, which for some hundred megabytes costs more than the rest of
// the export.

#include <optional>
#include <utility>

#include "coppice/base/progress.h"
#include "coppice/io_mesh/glb_parts_internal.h"

namespace coppice::io_internal {
namespace {

using nlohmann::json;

// Bytes of an image, up to a size that a reader could still decode.
constexpr std::uint64_t kMaxImageBytes = std::uint64_t{256} << 20;

struct GlbImage {
    std::string bytes;
    const char* type;
    std::size_t view = 0;
};

// A material with images that are part of the file.
class GlbMaterial {
  public:
    GlbMaterial(const MaterialFiles& files, GlbLayout& layout) : files_(files) {
        json& surface = material_["pbrMetallicRoughness"];
        material_["name"] = files.name;
        surface["metallicFactor"] = 0.0;
        surface["baseColorTexture"] = add(files.color, layout);
        if (!files.normal.empty()) material_["normalTexture"] = add(files.normal, layout);
        if (files.packed.empty()) return;
        surface["metallicRoughnessTexture"] = add(files.packed, layout);
        material_["occlusionTexture"] = surface["metallicRoughnessTexture"];
    }

    void describe(json& file) const {
        json images = json::array(), textures = json::array();
        for (const GlbImage& image : images_) {
            textures.push_back({{"sampler", 0}, {"source", images.size()}});
            images.push_back({{"bufferView", image.view}, {"mimeType", image.type}});
        }
        constexpr int kRepeat = 10497, kLinear = 9729, kMipMaps = 9987;
        file["materials"] = json::array({material_});
        file["images"] = std::move(images);
        file["textures"] = std::move(textures);
        file["samplers"] = {
            {{"wrapS", kRepeat}, {"wrapT", kRepeat}, {"magFilter", kLinear}, {"minFilter", kMipMaps}}};
    }

    void write(AtomicFile& file) const {
        for (const GlbImage& image : images_) {
            file.write(image.bytes);
            file.write(std::string((4 - image.bytes.size() % 4) % 4, '\0'));
        }
    }

  private:
    json add(const std::filesystem::path& path, GlbLayout& layout) {
        const auto made = files_.bytes.find(path);
        GlbImage image{made != files_.bytes.end() ? made->second : read_file(path, kMaxImageBytes),
                       "image/png"};
        const bool is_jpeg = image.bytes.starts_with("\xff\xd8");
        if (is_jpeg) image.type = "image/jpeg";
        if (!is_jpeg && !image.bytes.starts_with("\x89PNG"))
            throw InvalidInput(path.string() + " is neither a PNG nor a JPEG image");
        image.view = layout.add_bytes(image.bytes.size());
        images_.push_back(std::move(image));
        return {{"index", images_.size() - 1}};
    }

    const MaterialFiles& files_;
    json material_;
    std::vector<GlbImage> images_;
};

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

// Returns the name of an attribute in glTF: `_ORDER` of `order`.
std::string glb_name(std::string name) {
    for (char& c : name) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return "_" + name;
}

// Creates the mesh with one vertex for every place of the texture, divided for tangents if requested; none
// without a texture.
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
    for (const VertexAttribute& a : mesh.attributes) out[glb_name(a.name)] = add(sizeof(float), "SCALAR");
    return out;
}

}  // namespace

void write_glb(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    write_glb(file, mesh, nullptr, ctx);
}

void write_glb(AtomicFile& file, const MeshView& given, GlbMotionPart* motion, const Context& whole) {
    constexpr float kShareOfRest = 0.15f;
    const Context ctx = narrow_progress(whole, 0, motion != nullptr ? kShareOfRest : 1);
    const bool has_tangents = given.material != nullptr && !given.material->normal.empty();
    std::optional<SplitMesh> split;
    split_mesh(given, has_tangents, split, ctx);
    const MeshView& mesh = split ? split->view : given;
    std::vector<Vec3> normals = smooth_normals(given);
    if (split) normals = split_vectors(normals, *split);
    const std::vector<Tangent> tangents =
        has_tangents ? compute_tangents(*split, normals, ctx) : std::vector<Tangent>();
    GlbLayout layout;
    const json attributes = describe_attributes(mesh, split, has_tangents, layout);
    const std::size_t corners = 3 * mesh.triangle_count();
    const std::size_t indices =
        layout.add(corners * sizeof(std::uint32_t), kElementArrayBuffer, kUnsignedInt, corners, "SCALAR");
    json primitive{{"attributes", attributes}, {"indices", indices}};
    const GlbVertices vertices{given, split, normals, tangents};
    if (motion != nullptr) motion->lay_out(vertices, primitive, layout);
    std::optional<GlbMaterial> material;
    if (mesh.material != nullptr) material.emplace(*mesh.material, layout);
    json text = describe_tree(mesh, std::move(primitive), layout);
    if (material) material->describe(text);
    if (motion != nullptr) motion->describe(text);
    write_glb_head(file, text.dump(), layout.bytes());
    write_vectors(file, mesh.positions, {0, 0.3f}, ctx);
    write_vectors(file, normals, {0.4f, 0.6f}, ctx);
    if (split) write_texture(file, split->table.places, ctx);
    write_tangents(file, tangents, ctx);
    if (split) write_blends(file, split->table.blends, ctx);
    for (const VertexAttribute& a : mesh.attributes)
        write_attribute(file, a, split, mesh.positions.size(), ctx);
    write_triangles(file, mesh, {0.7f, 1}, ctx);
    if (motion != nullptr) motion->write(file, vertices, narrow_progress(whole, kShareOfRest, 1));
    if (material) material->write(file);
}

}  // namespace coppice::io_internal
