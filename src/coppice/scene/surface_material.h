#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/io_mesh/material.h"
#include "coppice/mesh/height_texture.h"
#include "coppice/render/png_reader.h"
#include "coppice/system/folder_sandbox.h"
#include "coppice/texture/bark.h"
#include "coppice/texture/cut.h"

namespace coppice {

/// A material of a scene: images in files, or bark or cut wood made by program.
struct SurfaceMaterial {
    MaterialFiles files;                   ///< without images for bark
    std::filesystem::path heights;         ///< image of the heights; empty if there is none
    std::shared_ptr<const BarkMaps> bark;  ///< images that are made by program; null for files
    std::optional<TileSize> tile;          ///< extent of the images, if known

    bool empty() const { return !bark && files.empty(); }  ///< whether there are no images
};

/// Returns the material of the images with names that begin like that of the colour, PREFIX_color.png. Throws
/// InvalidInput for another name, IoError if there is no colour, or an image is refused by the sandbox (may
/// be null).
SurfaceMaterial load_surface_material(const std::filesystem::path& color, const FolderSandbox* sandbox);

/// Makes the material of a bark. Throws as make_bark().
SurfaceMaterial make_bark_material(const BarkOptions& options, const Context& ctx);

/// Makes the material of a picture of cut wood. Throws as make_cut().
SurfaceMaterial make_cut_material(const CutOptions& options, const Context& ctx);

/// Returns the approximate memory [bytes].
std::uint64_t compute_memory(const SurfaceMaterial& material);

/// Returns the heights of a material. Throws InvalidInput if it has none, or their image has no scale.
HeightTexture load_heights(const SurfaceMaterial& material, const Context& ctx);

/// Returns the images of a material for a file of a mesh, or of an animation. Bark is written next to OBJ and
/// USDA, as FILE_NAME_color.png and so on for a material called NAME; for GLB, which contains its images, and
/// for images of the surface, it is returned.
MaterialFiles write_images(const SurfaceMaterial& material, const std::filesystem::path& file,
                           const Context& ctx);
/// The same for the materials of the slots of a surface, which get different names; those of empty ones have
/// no images.
std::vector<MaterialFiles> write_images(std::span<const SurfaceMaterial> materials,
                                        const std::filesystem::path& file, const Context& ctx);

}  // namespace coppice
