#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "coppice/base/vec.h"
#include "coppice/extract/plot/plot.h"
#include "coppice/extract/stem/tree_figures.h"
#include "coppice/io_skeleton/length_unit.h"
#include "figures.h"

namespace coppice::cli {

/// The table of the trees that `coppice extract` writes to a folder.
inline constexpr const char* kTreeTable = "trees.csv";
/// Name of the journal of a batch.
inline constexpr const char* kBatchJournal = "journal.sqlite";

/// Columns of a table of trees.
struct TreeColumns {
    bool of_files = false;  ///< for many files: input file of each row, and the error
    bool of_plots = false;  ///< for plots: stem circles, crowns, points, colours
    bool with_ids = false;  ///< for plots with tree ids
};

/// The figures of a tree, or of a file without a tree.
struct TreeRow {
    std::string input = {};                 ///< its input file
    std::size_t tree = 0;                   ///< its number in the file, from 1; 0: there is no tree
    std::optional<std::uint32_t> id = {};   ///< id of its points
    std::string skeleton = {};              ///< file of its skeleton
    std::optional<Vec3d> foot = {};         ///< [m] in the coordinates of the file
    const TreeFigures* figures = nullptr;   ///< figures of its skeleton; may be null
    bool of_points = true;                  ///< meshes have no circles and no intervals
    const PlotTree* of_plot = nullptr;      ///< its figures in a plot; may be null
    std::string color = {};                 ///< number of its points
    std::string warnings = {}, error = {};  ///< warnings to check; the reason why there is no skeleton
};

/// Adds the figures of the circle fitted to the points of a stem: null if they are unknown.
void add_circle(Json& out, const StemDiameter& d, const std::string& prefix = {}, bool is_known = true,
                LengthUnit unit = LengthUnit::m);

/// Returns a row of the table, with the same columns for every row; unknown values are null. Defines
/// the names of the columns.
Json tree_row(const TreeRow& row, const TreeColumns& columns);

}  // namespace coppice::cli
