#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coppice/extract/plot/plot.h"
#include "coppice/io_points/reader.h"
#include "extract_outputs.h"
#include "run.h"

namespace coppice::cli {

/// Labels of points that belong to no tree, or are not wood.
inline constexpr Rgb kNoTreeColor{150, 150, 150};

/// A plot that was written.
struct WrittenPlot {
    PlotExtraction plot;    ///< its warnings include the failures of writing
    std::string extension;  ///< that of its skeletons: ".swc"
    std::string summary;    ///< summary for people
};

/// Writes tree_001.swc and so on, trees.csv, taper.csv and the other requested outputs, as stages of the run,
/// and reports its counts. The folder, or the new files of an existing folder, appear as a whole or not at
/// all. The row of a tree reports if its surface failed.
WrittenPlot write_plot(Run& run, const PointFile& scan, PlotExtraction plot, const ExtractOutputs& outputs);

/// Returns the rows of a table for one plot; for many plots `input` is the name of this input file, and
/// `folder` that of its skeletons.
std::vector<Json> plot_rows(const WrittenPlot& written, const std::string& input = {},
                            const std::filesystem::path& folder = {});

}  // namespace coppice::cli
