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
#include "run.h"

namespace coppice::cli {

/// One of many files of which each becomes a skeleton by itself.
struct BatchFile {
    std::filesystem::path input, skeleton;
    std::filesystem::path mesh;         ///< surface of the skeleton; or none
    std::filesystem::path points;       ///< labelled points of a cloud; or none
    std::optional<FileKind> kind = {};  ///< none where it cannot be told, which working on it tells of
};

struct Batch {
    std::filesystem::path folder;  ///< of what is written
    std::vector<BatchFile> files;
    std::size_t passed_over = 0;  ///< files within folders that are neither meshes nor points
};

/// Whether these inputs are many files: several, or a folder.
bool is_batch(std::span<const std::filesystem::path> inputs);

/// The files that are named, and the meshes and clouds of points within folders, each with what is written of
/// it: its own name with the ending of skeletons, with `mesh`, ".ply", and `points`, "_points.ply". Throws
/// UsageError where two would be the same file, or one would overwrite an input, and where `folder` is none;
/// IoError where the folder above it is missing; InvalidInput where there are no files.
Batch plan_batch(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& folder,
                 const WriteSkeletonOptions& write, const std::filesystem::path& mesh,
                 const std::filesystem::path& points);

/// The table of a batch, trees.csv: a row for each tree, or for a file of which there is none. It has what
/// that of a plot has of trees.
class BatchTable {
  public:
    /// Makes the folder where it is missing. Throws IoError.
    explicit BatchTable(const Batch& batch);

    /// The trees of a file. `of_points` says whether they are of a cloud: else nothing is known of circles,
    /// nor of how sure volumes are.
    void add(const BatchFile& file, const ExtractResult& result, std::span<const TreeFigures> trees,
             bool of_points);
    void add_failure(const BatchFile& file, std::string_view error);
    /// The table appears.
    void commit() { table_.commit(); }

    const Figure::List& rows() const { return rows_; }

  private:
    void add_row(const Figures& row);

    CsvFile table_;
    Figure::List rows_;
};

}  // namespace coppice::cli
