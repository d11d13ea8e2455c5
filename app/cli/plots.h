#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/extract/plot/plot.h"
#include "coppice/io/map/map_file.h"
#include "coppice/io/points/reader.h"
#include "coppice/io/skeleton/writer.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "run.h"

namespace coppice::cli {

/// What is written of a plot.
struct PlotFiles {
    std::filesystem::path folder;
    std::filesystem::path mesh;         ///< ".ply": each tree as a surface; or none
    std::filesystem::path tree_points;  ///< all points, with what they are; or none
    std::filesystem::path leaf_points;  ///< of all trees; or none
    std::filesystem::path map;          ///< places of stems and outlines of crowns; or none
    std::filesystem::path crowns;       ///< the convex hulls of all crowns, a mesh; or none
    MapCrs crs;                         ///< of the coordinates, for the map
    CoordinateSystem system;            ///< of the points
    WriteSkeletonOptions write;
    MeshOptions surface = options_of_written_surface();
};

/// Whether -o names a folder: by a slash at its end, because it is one, or for want of an ending where no
/// format is asked for.
bool is_plot_folder(const std::filesystem::path& output, SkeletonFormat format);

/// Of points that belong to no tree, or are no wood.
inline constexpr Rgb kNoTreeColor{150, 150, 150};

/// The path without the slash at its end.
std::filesystem::path trimmed(const std::filesystem::path& path);

/// The ending of the skeletons in a folder without its point: "swc" where no format is asked for.
std::string ending_of(const WriteSkeletonOptions& write);

/// Throws UsageError where `folder` is no folder, skeletons cannot be written in that format, or `mesh` is
/// not an extension of surfaces or is that of the skeletons; IoError where the folder above it is missing.
void check_tree_folder(const std::filesystem::path& folder, const WriteSkeletonOptions& write,
                       const std::filesystem::path& mesh);

/// Throws UsageError for a name that is none of a map; IoError where its folder is missing.
void check_map_output(const std::filesystem::path& path);

/// Throws what writing would throw in the end: UsageError for endings that name no format, IoError where a
/// folder is missing.
void check_plot_files(const PlotFiles& files);

/// A plot that was written.
struct WrittenPlot {
    PlotExtraction plot;  ///< with what went wrong when it was written among the warnings
    std::string ending;   ///< of the names of its skeletons: ".swc"
    std::string summary;  ///< what came out, for people
};

/// Writes tree_001.swc and so on, trees.csv, taper.csv, and what else is asked for, as stages of the run, and
/// fills its counts. The folder appears whole, or what is new in it does; nothing of it where that fails. A
/// tree of which no surface can be made says so in its row.
WrittenPlot write_plot(Run& run, const PaintedPoints& scan, PlotExtraction plot, const PlotFiles& files);

/// The rows of a table of one plot; or of many, where `input` names the file of this one, and `folder` that
/// of its skeletons.
std::vector<Figures> plot_rows(const WrittenPlot& written, const std::string& input = {},
                               const std::filesystem::path& folder = {});

}  // namespace coppice::cli
