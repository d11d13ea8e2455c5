#include "coppice/io_mesh/glb_materials_internal.h"

#include "coppice/io_mesh/image_file_internal.h"

namespace coppice::io_internal {
namespace {

using nlohmann::json;

json& get_array(json& file, const char* key) {
    json& out = file[key];
    if (out.is_null()) out = json::array();
    return out;
}

}  // namespace

void GlbMaterials::add(const MaterialFiles& files, GlbLayout& layout) {
    materials_.push_back(&files);
    for (const auto* path : {&files.color, &files.normal, &files.packed})
        if (!path->empty()) add_image(files, *path, layout);
}

std::size_t GlbMaterials::describe(json& file) const {
    json &materials = get_array(file, "materials"), &textures = get_array(file, "textures"),
         &images = get_array(file, "images");
    const std::size_t first = materials.size(), first_texture = textures.size();
    const auto texture = [&](const std::filesystem::path& path) {
        return json{{"index", first_texture + index_of_image_.at(path)}};
    };
    for (const MaterialFiles* files : materials_) {
        json material{{"name", files->name}};
        json& surface = material["pbrMetallicRoughness"];
        surface["metallicFactor"] = 0.0;
        const Vec3 c = files->base_color;
        if (c != Vec3{1, 1, 1}) surface["baseColorFactor"] = {c.x, c.y, c.z, 1.0};
        if (!files->color.empty()) surface["baseColorTexture"] = texture(files->color);
        if (!files->normal.empty()) material["normalTexture"] = texture(files->normal);
        if (!files->packed.empty()) {
            surface["metallicRoughnessTexture"] = texture(files->packed);
            material["occlusionTexture"] = texture(files->packed);
        }
        if (files->cut_out) {
            material["alphaMode"] = "MASK";
            material["alphaCutoff"] = 0.5;
        }
        if (files->double_sided) material["doubleSided"] = true;
        materials.push_back(std::move(material));
    }
    for (const Image& image : images_) {
        textures.push_back({{"sampler", 0}, {"source", images.size()}});
        images.push_back({{"bufferView", image.view}, {"mimeType", image.type}});
    }
    constexpr int kRepeat = 10497, kLinear = 9729, kMipMaps = 9987;
    if (!images.empty()) {
        file["samplers"] = {
            {{"wrapS", kRepeat}, {"wrapT", kRepeat}, {"magFilter", kLinear}, {"minFilter", kMipMaps}}};
    } else {
        file.erase("images");
        file.erase("textures");
    }
    return first;
}

void GlbMaterials::write(AtomicFile& file) const {
    for (const Image& image : images_) {
        file.write(image.bytes);
        file.write(std::string((4 - image.bytes.size() % 4) % 4, '\0'));
    }
}

void GlbMaterials::add_image(const MaterialFiles& files, const std::filesystem::path& path,
                             GlbLayout& layout) {
    const auto [known, is_new] = index_of_image_.try_emplace(path, images_.size());
    if (!is_new) return;
    const auto made = files.bytes.find(path);
    Image image{made != files.bytes.end() ? made->second : read_image(path), "image/png"};
    if (check_image(image.bytes, path) == ImageFormat::jpeg) image.type = "image/jpeg";
    image.view = layout.add_bytes(image.bytes.size());
    images_.push_back(std::move(image));
}

}  // namespace coppice::io_internal
