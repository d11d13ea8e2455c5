#pragma once

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

}  // namespace coppice
