#pragma once

#include <filesystem>
#include <string>

#include "coppice/pipeline/mesh_skeleton.h"
#include "run.h"

namespace coppice::cli {

/// Writes the mesh of a surface, whichever method made it.
void write_surface(const std::filesystem::path& path, const MeshResult& result, const Context& ctx);

/// Puts the figures of a surface into the report; returns what to say of it.
std::string count_surface(Run& run, const MeshResult& result);

/// Makes and writes the surface of --then-mesh; returns what is said of it after the rest, with a semicolon
/// before it. Nothing where `path` is empty.
std::string then_mesh(Run& run, const std::filesystem::path& path, const Skeleton& skeleton,
                      const MeshOptions& options);

}  // namespace coppice::cli
