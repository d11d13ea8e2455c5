#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "coppice/base/vec.h"
#include "coppice/extract/plot/plot.h"
#include "coppice/extract/stem/tree_figures.h"
#include "figures.h"

namespace coppice::cli {

/// The table of the trees that `coppice extract` writes to a folder.
inline constexpr const char* kTreeTable = "trees.csv";

/// Which columns a table of trees has.
struct TreeColumns {
    bool of_files = false;  ///< of many files: which file each row is of, and what went wrong with it
    bool of_plots = false;  ///< of plots: stems as circles, crowns, points, colours
    bool with_ids = false;  ///< of plots whose points have ids of trees
};

/// What is known of a tree, or of a file of which there is none.
struct TreeRow {
    std::string input = {};                 ///< the file that it is of
    std::size_t tree = 0;                   ///< its number in the file, from 1; 0: there is none
    std::optional<std::uint32_t> id = {};   ///< of its points
    std::string skeleton = {};              ///< the file of its skeleton
    std::optional<Vec3d> foot = {};         ///< [m] in the coordinates of the file
    const TreeFigures* figures = nullptr;   ///< of its skeleton; or none
    bool of_points = true;                  ///< of a mesh there are no circles, and no intervals
    const PlotTree* of_plot = nullptr;      ///< what a plot knows of it; or none
    std::string color = {};                 ///< of its points
    std::string warnings = {}, error = {};  ///< what to look at; why there is no skeleton
};

/// A row of the table, the same columns for every row; what is not known is NotChecked. This is where columns
/// have their names.
Figures tree_row(const TreeRow& row, const TreeColumns& columns);

}  // namespace coppice::cli
