#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/extract/plot/plot.h"
#include "coppice/io_database/map_file.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "run.h"

namespace coppice::cli {

/// Optional outputs of a plot.
struct PlotFiles {
    std::filesystem::path folder;
    std::filesystem::path mesh;         ///< ".ply": extension of the surfaces of the trees; may be empty
    std::filesystem::path tree_points;  ///< all points with their labels; may be empty
    std::filesystem::path leaf_points;  ///< stem sections of all trees; may be empty
    std::filesystem::path map;          ///< positions of stems and outlines of crowns; may be empty
    std::filesystem::path crowns;       ///< the convex hulls of all crowns as a mesh; may be empty
    MapCrs crs;                         ///< coordinate reference system, for the map
    CoordinateSystem system;            ///< attributes of the input points
    WriteSkeletonOptions write;
    MeshOptions surface = options_of_written_surface();
};

/// Returns whether -o names a folder: it ends in a slash, is an existing folder, or has no extension while no
/// format is given.
bool is_plot_folder(const std::filesystem::path& output, SkeletonFormat format);

/// Labels of points that belong to no tree, or are not wood.
inline constexpr Rgb kNoTreeColor{150, 150, 150};

/// Returns the path without a trailing slash.
std::filesystem::path trimmed(const std::filesystem::path& path);

/// Returns the extension of the skeletons in a folder without its point: "swc" by default.
std::string choose_ending(const WriteSkeletonOptions& write);

/// Throws UsageError if `folder` is not a folder, skeletons cannot be written in that format, or `mesh` is
/// not an extension of surfaces or equals that of the skeletons; IoError if the parent folder does not exist.
void check_tree_folder(const std::filesystem::path& folder, const WriteSkeletonOptions& write,
                       const std::filesystem::path& mesh);

/// Throws UsageError if the name is not that of a map; IoError if its folder does not exist.
void check_map_output(const std::filesystem::path& path);

/// Throws early the errors that writing would throw: UsageError for unsupported extensions, IoError for a
/// folder that does not exist.
void check_plot_files(const PlotFiles& files);

/// A plot that was written.
struct WrittenPlot {
    PlotExtraction plot;  ///< its warnings include the failures of writing
    std::string ending;   ///< extension of its skeletons: ".swc"
    std::string summary;  ///< summary for people
};

/// Writes tree_001.swc and so on, trees.csv, taper.csv and the other requested outputs, as stages of the run,
/// and reports its counts. The folder, or the new files of an existing folder, appear as a whole or not at
/// all. The row of a tree reports if its surface failed.
WrittenPlot write_plot(Run& run, const PointCloud& scan, PlotExtraction plot, const PlotFiles& files);

/// Returns the rows of a table for one plot; for many plots `input` is the name of this input file, and
/// `folder` that of its skeletons.
std::vector<Json> plot_rows(const WrittenPlot& written, const std::string& input = {},
                            const std::filesystem::path& folder = {});

}  // namespace coppice::cli
