#include "coppice/scene/drawn_material.h"

#include <algorithm>

#include "coppice/base/id.h"
#include "coppice/render/picture.h"
#include "coppice/system/file.h"

namespace coppice {

RenderMaterial make_render_material(const BarkMaps& maps) {
    const auto image = [&](const auto& texels, const auto& pixel) {
        Image out(maps.width, maps.height);
        std::ranges::transform(texels, out.pixels.begin(), pixel);
        return out;
    };
    const auto of_color = [](const BarkMaps::Texel& t) { return Image::Pixel{t[0], t[1], t[2], 255}; };
    const auto of_value = [](std::uint8_t v) { return Image::Pixel{v, v, v, 255}; };
    return {image(maps.color, of_color), image(maps.normal, of_color), image(maps.roughness, of_value),
            image(maps.occlusion, of_value)};
}

RenderMaterial load_render_material(const MaterialFiles& files, const Context& ctx) {
    const auto load = [&](const std::filesystem::path& path) {
        if (path.empty()) return Image{};
        const auto found = files.bytes.find(path);
        return decode_picture(found == files.bytes.end() ? read_file(path, kLargestFile, ctx) : found->second,
                              path.string());
    };
    return {load(files.color), load(files.normal), load(files.roughness), load(files.occlusion)};
}

RenderMaterial load_render_material(const SurfaceMaterial& material, const Context& ctx) {
    return material.bark ? make_render_material(*material.bark) : load_render_material(material.files, ctx);
}

namespace {

template <class Material>
FaceMaterials load_each(std::span<const Material> materials, std::span<const std::uint32_t> of_face,
                        const Context& ctx) {
    FaceMaterials out;
    std::vector<std::uint32_t> loaded;  // per material: its index in `out`, or kNoIndex
    for (const Material& material : materials) {
        const auto index = static_cast<std::uint32_t>(out.materials.size());
        loaded.push_back(material.empty() ? kNoIndex : index);
        if (!material.empty()) out.materials.push_back(load_render_material(material, ctx));
    }
    if (out.materials.empty()) return out;
    for (const std::uint32_t m : of_face) out.of_face.push_back(loaded[m]);
    return out;
}

}  // namespace

FaceMaterials load_face_materials(std::span<const MaterialFiles> files,
                                  std::span<const std::uint32_t> of_face, const Context& ctx) {
    return load_each(files, of_face, ctx);
}

FaceMaterials load_face_materials(std::span<const SurfaceMaterial> materials,
                                  std::span<const std::uint32_t> of_face, const Context& ctx) {
    return load_each(materials, of_face, ctx);
}

}  // namespace coppice
