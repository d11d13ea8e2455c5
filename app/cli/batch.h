#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/extract/extract_result.h"
#include "coppice/extract/stem/tree_figures.h"
#include "coppice/io/file_kind.h"
#include "coppice/io/skeleton/writer.h"
#include "csv_file.h"
#include "plots.h"
#include "run.h"
#include "tree_row.h"

namespace coppice::cli {

/// One of many files of which each becomes a skeleton by itself, or a plot.
struct BatchFile {
    std::filesystem::path input = {};
    std::filesystem::path skeleton = {};  ///< or the folder of the skeletons of a plot
    std::filesystem::path mesh = {};      ///< surface of the skeleton; of a plot the ending of all; or none
    std::filesystem::path points = {};    ///< labelled points of a cloud; or none
    std::filesystem::path leaves = {};    ///< points that are left out as leaves; or none
    std::filesystem::path map = {}, crowns = {};  ///< of a plot; or none
    std::optional<FileKind> kind = {};  ///< none where it cannot be told, which working on it tells of
};

/// What is written of many files: endings, as ".ply", or none.
struct BatchOutputs {
    std::filesystem::path folder;
    WriteSkeletonOptions write;
    std::filesystem::path mesh, points, leaves, map, crowns;
    TreeColumns columns;  ///< of trees.csv
};

struct Batch {
    std::filesystem::path folder;  ///< of what is written
    TreeColumns columns;           ///< of trees.csv
    std::vector<BatchFile> files;
    std::size_t passed_over = 0;  ///< files within folders that are neither meshes nor points
};

/// Whether these inputs are many files: several, or a folder.
bool is_batch(std::span<const std::filesystem::path> inputs);

/// The files that are named, and the meshes and clouds of points within folders, of plots the clouds alone,
/// each with what is written of it: its own name with the ending of skeletons, none for the folder of a plot,
/// with that of meshes, and with "_points.ply", "_leaves.ply", "_map.gpkg", "_crowns.ply". Throws UsageError
/// where two would be the same file, or one would overwrite an input, where the folder is none, and for
/// endings that name no format; IoError where the folder above it is missing; InvalidInput where there are no
/// files.
Batch plan_batch(const std::vector<std::filesystem::path>& inputs, const BatchOutputs& outputs);

/// The table of a batch, trees.csv: a row for each tree, or for a file of which there is none.
class BatchTable {
  public:
    /// Makes the folder where it is missing. Throws IoError.
    explicit BatchTable(const Batch& batch);

    /// The trees of a file. `of_points` says whether they are of a cloud: else nothing is known of circles,
    /// nor of how sure volumes are. `error` is what went wrong after they were extracted, or empty.
    void add(const BatchFile& file, const ExtractResult& result, std::span<const TreeFigures> trees,
             bool of_points, const std::string& error = {});
    /// The trees of a plot.
    void add(const BatchFile& file, const WrittenPlot& plot);
    void add_failure(const BatchFile& file, std::string_view error);
    /// The table appears.
    void commit() { table_.commit(); }

    const Figure::List& rows() const { return rows_; }

  private:
    void add_row(const Figures& row);

    TreeColumns columns_;
    CsvFile table_;
    Figure::List rows_;
};

}  // namespace coppice::cli
