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
#include "coppice/scene/file_kind.h"
#include "csv_file.h"
#include "extract_outputs.h"
#include "plots.h"
#include "tree_row.h"

namespace coppice::cli {

/// One of many input files, each of which is converted to a skeleton or treated as a plot.
struct BatchFile {
    std::filesystem::path input;
    ExtractOutputs outputs = {};
    /// nullopt where it is unknown before the file is read; reading it then reports the error
    std::optional<FileKind> kind = {};
};

struct Batch {
    std::filesystem::path folder;  ///< output folder
    TreeColumns columns;           ///< columns of trees.csv
    std::vector<BatchFile> files;
    std::size_t passed_over = 0;  ///< number of files in the folders that are neither meshes nor points
};

/// Returns whether the inputs are a batch: several files, or a folder.
bool is_batch(std::span<const std::filesystem::path> inputs);

/// Returns the named files and the meshes and point clouds in folders (for plots only point clouds), each
/// with its outputs; see make_outputs(). Throws as check_batch_outputs(); UsageError if two outputs would be
/// the same file, or an output would overwrite an input; InvalidInput if there are no files.
Batch plan_batch(const std::vector<std::filesystem::path>& inputs, const ExtractOutputs& outputs,
                 const TreeColumns& columns);

/// The table of a batch, trees.csv: one row for each tree, and for each file without a tree.
class BatchTable {
  public:
    /// Creates the folder if it does not exist. Throws IoError.
    explicit BatchTable(const Batch& batch);

    /// Adds the trees of a file. `of_points` states whether they were extracted from a point cloud; without
    /// it there are no stem circles and no intervals of volumes. `error` is the message of a failure after
    /// the extraction, or empty.
    void add(const BatchFile& file, const ExtractResult& result, std::span<const TreeFigures> trees,
             bool of_points, const std::string& error = {});
    /// Adds the trees of a plot.
    void add(const BatchFile& file, const WrittenPlot& plot);
    void add_failure(const BatchFile& file, std::string_view error);
    /// Makes the complete table visible under its name.
    void commit() { table_.commit(); }

    const Json& rows() const { return rows_; }

  private:
    void add_row(const Json& row);

    TreeColumns columns_;
    CsvFile table_;
    Json rows_ = Json::array();
};

}  // namespace coppice::cli
