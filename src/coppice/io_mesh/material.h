#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "coppice/base/vec.h"

namespace coppice {

/// The images of a material for surfaces with texture coordinates; those without a name are left out. All are
/// PNG or JPEG and repeat.
struct MaterialFiles {
    std::string name = "bark";        ///< of the material
    std::filesystem::path color;      ///< base colour, sRGB
    std::filesystem::path normal;     ///< normals in tangent space, green up
    std::filesystem::path roughness;  ///< grey
    std::filesystem::path occlusion;  ///< grey: 0 = occluded
    std::filesystem::path packed;     ///< occlusion in red, roughness in green, metallic in blue
    /// Grey: the alpha of the colour, for OBJ; without it, that of the colour.
    std::filesystem::path opacity = {};
    /// Linear colour, multiplied with that of the image; the colour of a material without one.
    Vec3 base_color{1, 1, 1};
    bool cut_out = false;       ///< parts of the colour with an alpha below one half are holes
    bool double_sided = false;  ///< the surface is visible from both sides
    /// contents of images that are not in files, by their names; only for GLB, which contains its images
    std::map<std::filesystem::path, std::string> bytes;

    bool empty() const { return color.empty(); }  ///< whether there are no images
};

/// Returns the text as a name of a material that every format accepts: letters, digits and underscores.
std::string make_material_name(std::string text);

/// Extends the name of a material until no other one has it.
void make_name_unique(MaterialFiles& material, std::span<const MaterialFiles> others);

/// Returns the images with names that begin with `prefix`, as written by `coppice texture`: PREFIX_color.png,
/// and, where they exist, PREFIX_normal.png, PREFIX_roughness.png, PREFIX_occlusion.png and PREFIX_orm.png.
/// The name of the material is the last part of the prefix. Throws IoError if there is no colour or a file
/// cannot be read, InvalidInput if an image is truncated or has a side of more than 32,768 pixels.
MaterialFiles find_material(const std::filesystem::path& prefix);

}  // namespace coppice
