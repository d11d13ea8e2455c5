#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "coppice/io/file_kind.h"
#include "coppice/io/points/reader.h"
#include "coppice/io/skeleton/reader.h"
#include "coppice/io/skeleton/writer.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/painted_points.h"
#include "run.h"

namespace coppice::cli {

/// What a file holds: all commands agree on it. A format that was asked for makes it a skeleton. Throws
/// UsageError when it is unknown.
FileKind kind_of_input(const std::filesystem::path& path, SkeletonFormat format = SkeletonFormat::automatic);

/// What a file of this name is to hold, as in `kind_of_output`. Throws UsageError when the ending is unknown.
FileKind kind_to_write(const std::filesystem::path& path, FileKind preferred);

/// The path of a file, absolute and without symbolic links, so that different names of it are equal; empty
/// where the system does not tell.
std::filesystem::path resolved_path(const std::filesystem::path& path);

/// The files that are named, and those within folders that are, in order of their names.
std::vector<std::filesystem::path> files_within(const std::vector<std::filesystem::path>& named);

/// "a skeleton", "a mesh", "a cloud of points"
std::string_view with_article(FileKind kind);

/// Says that a file of this kind is not `wanted`, such as "a scene", and which command takes it.
std::string remedy_for(const std::filesystem::path& path, FileKind kind, std::string_view wanted);

/// Throws what writing would throw in the end, before hours of work: IoError when the folder does not exist.
void check_output_folder(const std::filesystem::path& path);
/// The same, and UsageError when the name is not that of a mesh that can be written.
void check_mesh_output(const std::filesystem::path& path);
/// The same for skeletons.
void check_skeleton_output(const std::filesystem::path& path);
/// The same for points.
void check_points_output(const std::filesystem::path& path);
/// The same for points of which more is known than their places.
void check_painted_output(const std::filesystem::path& path);

/// Reads as a stage of the run; fills its counts and repairs, and warns of points that are odd. `up` is the
/// axis of the file that points up; GLB says so itself. `options` are none where the command has no options
/// for reading points. Throws UsageError for a file of another kind, with the command that makes a skeleton
/// of it.
SkeletonFile load_skeleton(Run& run, const std::filesystem::path& path, const ReadSkeletonOptions& options);
PolygonMesh load_mesh(Run& run, const std::filesystem::path& path, FileUp up = FileUp::z);
PointSet load_points(Run& run, const std::filesystem::path& path, FileUp up = FileUp::z,
                     const std::optional<ReadPointsOptions>& options = {});
PointFile load_point_file(Run& run, const std::filesystem::path& path, const PointColumns& columns, FileUp up,
                          const std::optional<ReadPointsOptions>& options = {});

/// Heading of the options that say how points are read.
inline constexpr const char* kReadPointsGroup = "Reading points";

/// ", 12 rays without return left out" for the summary, or nothing.
std::string text_of_rays_left_out(const PointFile& file);

/// The name of a figure with its unit, "length_um" or "volume_um3"; `power` is 1 for lengths.
std::string in_unit(std::string_view name, LengthUnit unit, int power = 1);

/// What was wrong with a skeleton, and the gaps and jumps between its cylinders, which are not.
Figures repairs_of(const RepairReport& report);
Figures joints_of(const RepairReport& report);

}  // namespace coppice::cli
