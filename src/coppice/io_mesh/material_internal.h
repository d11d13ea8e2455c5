#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/io_mesh/material.h"
#include "coppice/io_mesh/write_internal.h"

namespace coppice::io_internal {

/// Gives a mesh the materials of its faces, unless it has no texture coordinates or they have no images.
void set_materials(MeshView& mesh, std::span<const MaterialFiles> materials,
                   std::span<const std::uint32_t> face_materials);
/// Returns the materials that faces have, in their order. O(n).
std::vector<const MaterialFiles*> list_used_materials(const MeshView& mesh);

/// Returns the indices of the faces by material, ascending; rows of materials without faces are empty. O(n).
CompressedRows<std::uint32_t> group_by_material(const MeshView& mesh);

/// Returns the name of the material library of an OBJ file.
std::filesystem::path mtl_path(const std::filesystem::path& obj);
/// Writes the material library of an OBJ file, with images relative to its folder.
void write_mtl(const std::filesystem::path& obj, std::span<const MaterialFiles* const> materials);

/// Returns the definition of a material in a prim of a USDA file.
std::string usda_material(const std::filesystem::path& usda, const MaterialFiles& material,
                          std::string_view parent = "/tree");

}  // namespace coppice::io_internal
