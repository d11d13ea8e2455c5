#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/io_database/map_file.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "options.h"

namespace coppice::cli {

/// Headings of the options for the kinds of input of `coppice extract`.
inline constexpr const char* kMeshGroup = "From a mesh";
inline constexpr const char* kCloudGroup = "From a cloud of points";
inline constexpr const char* kPlotGroup = "From a plot of many trees (-o FOLDER)";

/// The files that an extraction writes; empty where not requested. For many files they are a folder and
/// extensions such as ".ply", from which make_outputs() makes the names for one of them.
struct ExtractOutputs {
    std::filesystem::path skeleton;     ///< for a plot the folder of its skeletons
    std::filesystem::path mesh;         ///< surface; for a plot the extension of the surfaces of its trees
    std::filesystem::path mapping;      ///< vertices of a mesh, coloured by their nodes
    std::filesystem::path leaf_points;  ///< points that are removed as leaves
    std::filesystem::path tree_points;  ///< all points with their labels
    std::filesystem::path map;          ///< positions of the stems and outlines of the crowns of a plot
    std::filesystem::path crowns;       ///< convex hulls of all crowns of a plot, as a mesh
    std::filesystem::path crs;          ///< coordinate reference system of the map: a name, not a file
    WriteSkeletonOptions write;
    MeshOptions surface = options_of_written_surface();
};

/// Declares the options for the outputs of one group; those of all inputs have no group.
void add_output_options(OptionList& options, ExtractOutputs& outputs, std::string_view group = {});

/// Throws early, before any work, the errors that writing the outputs of one tree, of one plot or of many
/// files would throw: UsageError for names with unsupported extensions, or in place of extensions;
/// IoError for a folder that does not exist.
void check_tree_outputs(const ExtractOutputs& outputs);
void check_plot_outputs(const ExtractOutputs& outputs);
void check_batch_outputs(const ExtractOutputs& outputs);

/// Returns the outputs of one of many files: in the folder, its own name with the extension of skeletons
/// (without one for the folder of a plot), with the extension of meshes, and with "_points.ply",
/// "_leaves.ply", "_map.gpkg", "_crowns.ply"; those of points only if `may_be_points`.
ExtractOutputs make_outputs(const std::filesystem::path& input, const ExtractOutputs& batch, bool of_plots,
                            bool may_be_points);

/// Returns the files, and for a plot the folder of its skeletons, that are written.
std::vector<std::filesystem::path> written_files(const ExtractOutputs& outputs, bool of_plot);

/// Returns the coordinate reference system that the user specifies for the map, or else that of the points.
/// Throws UsageError if it is invalid, or there is no map.
MapCrs to_map_crs(const ExtractOutputs& outputs, const CoordinateSystem& points = {});

/// Returns whether -o names a folder: it ends in a slash, is an existing folder, or has no extension while no
/// format is given.
bool is_plot_folder(const ExtractOutputs& outputs);

/// Returns the path without a trailing slash.
std::filesystem::path trimmed(const std::filesystem::path& path);

/// Returns the extension of the skeletons in a folder: ".swc" by default.
std::string skeleton_extension(const WriteSkeletonOptions& write);

}  // namespace coppice::cli
