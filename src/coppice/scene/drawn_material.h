#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/io_mesh/material.h"
#include "coppice/render/material.h"
#include "coppice/scene/surface_material.h"
#include "coppice/texture/bark.h"

namespace coppice {

/// Memory [bytes] of a pixel of a material while it is drawn: four images and their levels.
constexpr double kBytesOfDrawnTexel = 32;

/// Returns the images of bark for render().
RenderMaterial make_render_material(const BarkMaps& maps);

/// Reads the images of a material for render(). Throws IoError if an image cannot be read, InvalidInput for
/// other content.
RenderMaterial load_render_material(const MaterialFiles& files, const Context& ctx = {});
/// The same for a material of a scene, of files or bark.
RenderMaterial load_render_material(const SurfaceMaterial& material, const Context& ctx = {});

/// Materials of the faces of a mesh for render().
struct FaceMaterials {
    std::vector<RenderMaterial> materials;  ///< those with images
    std::vector<std::uint32_t> of_face;     ///< as RenderScene::face_materials
};

/// Reads the images of several materials. `of_face` is the index of one for each face, or empty: all faces
/// have the first. Faces of materials without images have none. Throws as load_render_material().
FaceMaterials load_face_materials(std::span<const MaterialFiles> files,
                                  std::span<const std::uint32_t> of_face, const Context& ctx = {});
/// The same for materials of a scene.
FaceMaterials load_face_materials(std::span<const SurfaceMaterial> materials,
                                  std::span<const std::uint32_t> of_face, const Context& ctx = {});

}  // namespace coppice
