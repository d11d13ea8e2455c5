#pragma once

#include <filesystem>
#include <string>

#include "coppice/io/skeleton/reader.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"
#include "run.h"

namespace coppice::cli {

enum class FileKind { skeleton, mesh, points };

/// What a file holds, by its name, and by its content where the name leaves it open (OBJ, PLY, TXT, CSV,
/// unknown endings): all commands agree on it.
FileKind kind_of_input(const std::filesystem::path& path);

/// What a file of this name is to hold. Throws UsageError when the ending is unknown; a name that fits both
/// (OBJ, PLY) is of the kind `preferred`.
FileKind kind_of_output(const std::filesystem::path& path, FileKind preferred);

/// Throws what writing would throw in the end, before hours of work: IoError when the folder does not exist.
void check_output_folder(const std::filesystem::path& path);
/// The same, and UsageError when the name is not that of a mesh that can be written.
void check_mesh_output(const std::filesystem::path& path);
/// The same for points.
void check_points_output(const std::filesystem::path& path);

/// Reads as a stage of the run; fills its counts and repairs.
SkeletonFile load_skeleton(Run& run, const std::filesystem::path& path, const ReadSkeletonOptions& options);
PolygonMesh load_mesh(Run& run, const std::filesystem::path& path);
PointSet load_points(Run& run, const std::filesystem::path& path);

Figures repairs_of(const RepairReport& report);

}  // namespace coppice::cli
