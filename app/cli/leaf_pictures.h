#pragma once

#include <filesystem>

#include "coppice/mesh/mesh.h"
#include "coppice/render/render.h"
#include "coppice/scene/drawn_material.h"
#include "coppice/scene/surface_leaves.h"
#include "run.h"

namespace coppice::cli {

/// Help of --instances.
inline constexpr const char* kInstancesHelp =
    "Storage of leaves: instanced once with their places (.glb, .usda), or merged meshes for programs that "
    "do not "
    "read instances.";

/// Draws a surface with its bark and its leaves (may be null), and writes the image.
void write_leafed_picture(Run& run, const std::filesystem::path& path, const PolygonMesh& surface,
                          const FaceMaterials& bark, const SurfaceLeaves* leaves,
                          const RenderOptions& options);

/// Adds the figures of leaves to the report; returns their summary.
std::string count_leaves(Run& run, const SurfaceLeaves& leaves);

}  // namespace coppice::cli
