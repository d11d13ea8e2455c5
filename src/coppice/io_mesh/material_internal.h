#pragma once

#include <filesystem>
#include <string>

#include "coppice/io_mesh/material.h"

namespace coppice::io_internal {

/// Returns the name of the material library of an OBJ file.
std::filesystem::path mtl_path(const std::filesystem::path& obj);
/// Writes the material library of an OBJ file, with images relative to its folder.
void write_mtl(const std::filesystem::path& obj, const MaterialFiles& material);

/// Returns the definition of a material in the prim "tree" of a USDA file.
std::string usda_material(const std::filesystem::path& usda, const MaterialFiles& material);

}  // namespace coppice::io_internal
