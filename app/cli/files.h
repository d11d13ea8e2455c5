#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/io_mesh/reader.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_cloud.h"
#include "coppice/scene/file_kind.h"
#include "coppice/scene/surface_leaves.h"
#include "run.h"

namespace coppice::cli {

/// Returns the kind of a file or of an object in memory; all commands use this function. An explicit format
/// makes a file a skeleton. Throws UsageError if the kind is unknown.
FileKind kind_of_input(const Run& run, const std::filesystem::path& path,
                       SkeletonFormat format = SkeletonFormat::automatic);

/// Returns the leaves of a surface in memory; null if it has none, or the name is that of a file.
std::shared_ptr<const SurfaceLeaves> find_held_leaves(const Run& run, const std::filesystem::path& path);
/// Returns the text of a name in memory, such as a scene; null if it names a file.
std::shared_ptr<const std::string> find_held_text(const Run& run, const std::filesystem::path& path);

/// Returns the kind of an output with this name, as `kind_of_output` does. Throws UsageError if the extension
/// is unknown.
FileKind kind_to_write(const std::filesystem::path& path, FileKind preferred);

/// Returns the absolute path of a file without symbolic links, so that different names of one file are equal;
/// empty if the system cannot determine it.
std::filesystem::path resolved_path(const std::filesystem::path& path);

/// Returns the named files, and the files in the named folders, in order of their names.
std::vector<std::filesystem::path> files_within(const std::vector<std::filesystem::path>& named);

/// Returns the kind of a file, or nullopt where it cannot be determined before the file is read.
std::optional<FileKind> find_kind(const std::filesystem::path& path);

/// Creates a folder unless it exists; its parent must exist. Throws IoError.
void create_folder(const std::filesystem::path& path);

/// "a skeleton", "a mesh", "a cloud of points"
std::string_view with_article(FileKind kind);

/// Returns the error for a file of this kind where another one, such as "a scene", is required; it names the
/// command that accepts the file.
std::string remedy_for(const std::filesystem::path& path, FileKind kind, std::string_view wanted);

/// Throws early, before hours of work, the IoError that writing would throw: the folder does not exist.
void check_output_folder(const std::filesystem::path& path);
/// The same, and UsageError if the name is not that of a supported mesh format.
void check_mesh_output(const std::filesystem::path& path);
/// The same for skeletons.
void check_skeleton_output(const std::filesystem::path& path);
/// The same for points.
void check_points_output(const std::filesystem::path& path);
/// The same for points that have attributes.
void check_cloud_output(const std::filesystem::path& path);

/// Reads a file as a stage of the run; reports its counts and repairs, and warns of suspicious points. `up`
/// is the axis of the file that points up; GLB defines its own. `options` is empty for commands without
/// options for reading points. Throws UsageError for a file of another kind, naming the command that converts
/// it to a skeleton.
SkeletonFile load_skeleton(Run& run, const std::filesystem::path& path, const ReadSkeletonOptions& options);
PolygonMesh load_mesh(Run& run, const std::filesystem::path& path, FileUp up = FileUp::z);
MeshFile load_mesh_file(Run& run, const std::filesystem::path& path, std::span<const std::string> attributes,
                        FileUp up);
PointSet load_points(Run& run, const std::filesystem::path& path, FileUp up = FileUp::z,
                     const std::optional<ReadPointsOptions>& options = {});
PointFile load_point_file(Run& run, const std::filesystem::path& path, const PointColumns& columns, FileUp up,
                          const std::optional<ReadPointsOptions>& options = {});

/// Heading of the options for reading points.
inline constexpr const char* kReadPointsGroup = "Reading points";

/// Returns ", 12 rays without return left out" for the summary, or an empty text.
std::string text_of_rays_left_out(const PointFile& file);

/// Returns the name of a figure with its unit, "length_um" or "volume_um3"; `power` is 1 for lengths.
std::string in_unit(std::string_view name, LengthUnit unit, int power = 1);

/// Appends the unit to the name of a figure, for the given power of a length.
using FigureName = std::function<std::string(std::string_view name, int power)>;
/// Returns in_unit() for one unit.
FigureName names_in(LengthUnit unit);

/// Stores the unit of a file. Throws UsageError if it differs from that of the files before it.
void check_units(std::optional<LengthUnit>& before, const std::string& path, LengthUnit unit);

}  // namespace coppice::cli
