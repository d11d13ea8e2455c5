#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coppice/system/file.h"
#include "figures.h"

namespace coppice::cli {

/// Formats a figure as a CSV cell: numbers with seven digits, ten for map coordinates; texts quoted where
/// required (RFC 4180); empty for unknown
/// values.
std::string to_csv_cell(const Json& figure);

/// Returns rows with different names as CSV: the columns are in order of their first row, `error` last.
std::string to_csv(const std::vector<Json>& rows);

/// A table that is written row by row; the file is complete or not written at all.
class CsvFile {
  public:
    explicit CsvFile(const std::filesystem::path& path) : file_(path) {}

    /// The names of the first row become the header; all other rows must have the same names.
    void add(const Json& row);
    std::size_t rows() const { return rows_; }
    void commit() { file_.commit(); }

  private:
    AtomicFile file_;
    std::size_t rows_ = 0;
};

}  // namespace coppice::cli
