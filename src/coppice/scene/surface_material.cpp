#include "coppice/scene/surface_material.h"

#include <fmt/format.h>

#include <array>

#include "coppice/io_mesh/format.h"
#include "coppice/render/png_reader.h"
#include "coppice/scene/bark_images.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

constexpr std::uint64_t kMaxImageBytes = std::uint64_t{256} << 20;

/// Returns the name without "_color.png". Throws InvalidInput for another name.
std::string find_prefix(const std::filesystem::path& color) {
    const std::string name = color.string();
    for (const std::string_view end : {"_color.png", "_color.jpg"}) {
        if (name.ends_with(end)) return name.substr(0, name.size() - end.size());
    }
    throw InvalidInput(fmt::format(
        "'{}' is not the name of a colour; name PREFIX_color.png, as coppice texture writes it", name));
}

/// Calls use(path) for the images that exist.
template <class Use>
void for_each_image(const SurfaceMaterial& material, const Use& use) {
    const MaterialFiles& files = material.files;
    for (const auto* path : {&files.color, &files.normal, &files.roughness, &files.occlusion, &files.packed,
                             &material.heights}) {
        if (!path->empty()) use(*path);
    }
}

}  // namespace

SurfaceMaterial load_surface_material(const std::filesystem::path& color, const FolderSandbox* sandbox) {
    const std::string prefix = find_prefix(color);
    SurfaceMaterial out{.files = find_material(prefix)};
    std::error_code error;
    const std::filesystem::path heights = make_bark_file_name(prefix, "height");
    if (std::filesystem::exists(heights, error)) out.heights = heights;
    if (sandbox != nullptr) {
        for_each_image(out, [&](const std::filesystem::path& path) {
            sandbox->to_read(path.lexically_relative(sandbox->folder()).generic_string());
        });
    }
    out.tile = read_tile_size(read_file(out.files.color, kMaxImageBytes));
    return out;
}

SurfaceMaterial make_bark_material(const BarkOptions& options, const Context& ctx) {
    return {.bark = std::make_shared<const BarkMaps>(make_bark(options, ctx)),
            .tile = TileSize{options.tile_width, options.tile_height}};
}

SurfaceMaterial make_cut_material(const CutOptions& options, const Context& ctx) {
    return {.bark = std::make_shared<const BarkMaps>(make_cut(options, ctx)),
            .tile = TileSize{options.diameter, options.diameter}};
}

std::uint64_t compute_memory(const SurfaceMaterial& material) {
    constexpr std::uint64_t kBytesOfTexel = 10;
    return material.bark ? kBytesOfTexel * material.bark->size() : 0;
}

HeightTexture load_heights(const SurfaceMaterial& material, const Context& ctx) {
    if (material.bark) {
        const BarkMaps& maps = *material.bark;
        return {maps.width, maps.height, maps.high - maps.low, maps.heights};
    }
    if (material.heights.empty())
        throw InvalidInput("the material has no heights; they are in PREFIX_height.png");
    return decode_height_png(read_file(material.heights, kMaxImageBytes, ctx), material.heights.string());
}

MaterialFiles write_images(const SurfaceMaterial& material, const std::filesystem::path& file,
                           const Context& ctx) {
    MaterialFiles out = material.files;
    if (!material.bark) return out;
    const auto format = mesh_format_of_name(file);
    const bool is_apart = format == MeshFormat::obj || format == MeshFormat::usda;
    if (format && !is_apart && format != MeshFormat::glb) return {};
    const std::string prefix =
        fmt::format("{}_{}", std::filesystem::path(file).replace_extension().string(), out.name);
    for (BarkImage& image : encode_bark(*material.bark, ctx)) {
        const std::string name = make_bark_file_name(prefix, image.map);
        if (is_apart) {
            write_file(name, image.bytes);
        } else {
            out.bytes[name] = std::move(image.bytes);
        }
    }
    out.color = make_bark_file_name(prefix, "color");
    out.normal = make_bark_file_name(prefix, "normal");
    out.roughness = make_bark_file_name(prefix, "roughness");
    out.occlusion = make_bark_file_name(prefix, "occlusion");
    out.packed = make_bark_file_name(prefix, "orm");
    return out;
}

std::vector<MaterialFiles> write_images(std::span<const SurfaceMaterial> materials,
                                        const std::filesystem::path& file, const Context& ctx) {
    std::vector<MaterialFiles> out;
    for (SurfaceMaterial material : materials) {
        make_name_unique(material.files, out);
        const std::string name = material.files.name;
        out.push_back(material.empty() ? MaterialFiles{} : write_images(material, file, ctx));
        out.back().name = name;
    }
    return out;
}

}  // namespace coppice
