#include "coppice/io_mesh/material.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "coppice/base/error.h"
#include "coppice/io_mesh/image_file_internal.h"
#include "coppice/io_mesh/material_internal.h"
#include "coppice/system/file.h"

namespace coppice {
namespace io_internal {
namespace {

// Returns the path of an image as seen from the folder of another file.
std::string relative_name(const std::filesystem::path& image, const std::filesystem::path& file) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path from = fs::absolute(file, error).parent_path();
    const fs::path name = fs::absolute(image, error).lexically_relative(from);
    return name.empty() ? image.generic_string() : name.generic_string();
}

// Quotes a path for USD.
std::string to_asset(const std::string& path) {
    if (path.find('@') == std::string::npos) return "@" + path + "@";
    constexpr std::string_view kQuotes = "@@@";
    std::string inside = path;
    for (std::size_t at = 0; (at = inside.find(kQuotes, at)) != std::string::npos; at += kQuotes.size() + 1)
        inside.insert(at, 1, '\\');
    return fmt::format("{0}{1}{0}", kQuotes, inside);
}

}  // namespace

void set_materials(MeshView& mesh, std::span<const MaterialFiles> materials,
                   std::span<const std::uint32_t> face_materials) {
    if (mesh.texture.empty() || materials.empty() || materials.front().empty()) return;
    COPPICE_ASSERT(face_materials.empty() || face_materials.size() == mesh.face_count);
    mesh.materials = materials;
    mesh.face_materials = face_materials;
}

CompressedRows<std::uint32_t> group_by_material(const MeshView& mesh) {
    return group_by(mesh.face_materials, mesh.materials.size());
}

std::vector<const MaterialFiles*> list_used_materials(const MeshView& mesh) {
    if (mesh.materials.empty()) return {};
    std::vector<std::uint8_t> is_used(mesh.materials.size(), 0);
    if (mesh.face_materials.empty()) is_used[0] = 1;
    for (const std::uint32_t m : mesh.face_materials) is_used[m] = 1;
    std::vector<const MaterialFiles*> out;
    for (std::size_t m = 0; m < is_used.size(); ++m) {
        if (is_used[m] != 0) out.push_back(&mesh.materials[m]);
    }
    return out;
}

std::filesystem::path mtl_path(const std::filesystem::path& obj) {
    return std::filesystem::path(obj).replace_extension(".mtl");
}

void write_mtl(const std::filesystem::path& obj, std::span<const MaterialFiles* const> materials) {
    const std::filesystem::path path = mtl_path(obj);
    std::string text = "# Coppice\n";
    const auto add = [&](std::string_view word, const std::filesystem::path& image) {
        if (!image.empty()) text += fmt::format("{} {}\n", word, relative_name(image, path));
    };
    for (const MaterialFiles* material : materials) {
        const Vec3 c = material->base_color;
        text += fmt::format("newmtl {}\nKd {} {} {}\nKs 0 0 0\n", material->name, c.x, c.y, c.z);
        add("map_Kd", material->color);
        if (material->cut_out) add("map_d", material->opacity.empty() ? material->color : material->opacity);
        add("norm", material->normal);
        add("map_Pr", material->roughness);
    }
    write_file(path, text);
}

std::string usda_material(const std::filesystem::path& usda, const MaterialFiles& material,
                          std::string_view parent) {
    std::string inputs, images;
    const Vec3 c = material.base_color;
    const std::string prim = fmt::format("{}/{}", parent, material.name);
    const auto add = [&](std::string_view name, const std::filesystem::path& image, std::string_view type,
                         std::string_view output, std::string_view space, std::string_view more) {
        if (image.empty()) return;
        inputs += fmt::format("            {0} inputs:{1}.connect = <{2}/{1}.outputs:{3}>\n", type, name,
                              prim, output);
        images += fmt::format(
            "        def Shader \"{0}\"\n        {{\n            uniform token info:id = \"UsdUVTexture\"\n"
            "            asset inputs:file = {1}\n            token inputs:sourceColorSpace = \"{2}\"\n"
            "            token inputs:wrapS = \"repeat\"\n            token inputs:wrapT = \"repeat\"\n"
            "            float2 inputs:st.connect = <{3}/coordinates.outputs:result>\n{4}"
            "            {5} outputs:{6}\n        }}\n",
            name, to_asset(relative_name(image, usda)), space, prim, more,
            output == "rgb" ? "float3" : "float", output);
    };
    std::string factor;
    if (c != Vec3{1, 1, 1})
        factor = fmt::format("            float4 inputs:scale = ({}, {}, {}, 1)\n", c.x, c.y, c.z);
    if (material.cut_out) factor += "            float outputs:a\n";
    add("diffuseColor", material.color, "color3f", "rgb", "sRGB", factor);
    if (material.color.empty())
        inputs += fmt::format("            color3f inputs:diffuseColor = ({}, {}, {})\n", c.x, c.y, c.z);
    if (material.cut_out) {
        inputs += fmt::format(
            "            float inputs:opacity.connect = <{}/diffuseColor.outputs:a>\n"
            "            float inputs:opacityThreshold = 0.5\n",
            prim);
    }
    add("normal", material.normal, "normal3f", "rgb", "raw",
        "            float4 inputs:scale = (2, 2, 2, 1)\n            float4 inputs:bias = (-1, -1, -1, 0)\n");
    add("roughness", material.roughness, "float", "r", "raw", "");
    add("occlusion", material.occlusion, "float", "r", "raw", "");
    return fmt::format(
        "    def Material \"{0}\"\n    {{\n"
        "        token outputs:surface.connect = <{3}/surface.outputs:surface>\n"
        "        def Shader \"surface\"\n        {{\n"
        "            uniform token info:id = \"UsdPreviewSurface\"\n{1}            token outputs:surface\n"
        "        }}\n        def Shader \"coordinates\"\n        {{\n"
        "            uniform token info:id = \"UsdPrimvarReader_float2\"\n"
        "            string inputs:varname = \"st\"\n            float2 outputs:result\n        }}\n{2}    "
        "}}\n",
        material.name, inputs, images, prim);
}

}  // namespace io_internal

std::string make_material_name(std::string text) {
    for (char& c : text) {
        const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        if (!is_letter && (c < '0' || c > '9')) c = '_';
    }
    // Names in USD begin with a letter or an underscore.
    if (text.empty() || (text[0] >= '0' && text[0] <= '9')) text.insert(0, "bark_");
    return text;
}

void make_name_unique(MaterialFiles& material, std::span<const MaterialFiles> others) {
    while (std::ranges::any_of(others, [&](const auto& other) { return other.name == material.name; }))
        material.name += "_2";
}

MaterialFiles find_material(const std::filesystem::path& prefix) {
    namespace fs = std::filesystem;
    const auto if_there = [&](std::string_view kind) {
        for (const std::string_view extension : {"png", "jpg"}) {
            std::error_code error;
            fs::path path = fmt::format("{}_{}.{}", prefix.string(), kind, extension);
            if (fs::exists(path, error)) return path;
        }
        return fs::path();
    };
    MaterialFiles out{.name = make_material_name(prefix.filename().string()),
                      .color = if_there("color"),
                      .normal = if_there("normal"),
                      .roughness = if_there("roughness"),
                      .occlusion = if_there("occlusion"),
                      .packed = if_there("orm")};
    if (out.color.empty())
        throw IoError(fmt::format("there is no file {}_color.png; write the images by coppice texture",
                                  prefix.string()));
    for (const auto* image : {&out.color, &out.normal, &out.roughness, &out.occlusion, &out.packed}) {
        if (!image->empty()) io_internal::check_image(io_internal::read_image(*image), *image);
    }
    return out;
}

}  // namespace coppice
