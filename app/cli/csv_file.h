#pragma once

#include <filesystem>
#include <string>

#include "coppice/io/file.h"
#include "figures.h"

namespace coppice::cli {

/// A figure as a cell of CSV: numbers in seven digits, ten where they are coordinates of maps, empty where
/// nothing is known.
std::string csv_cell_of(const Figure& figure);

/// A table that is written row by row, and appears whole or not at all.
class CsvFile {
  public:
    explicit CsvFile(const std::filesystem::path& path) : file_(path) {}

    /// The names of the first row head the table; those after it have the same.
    void add(const Figures& row);
    std::size_t rows() const { return rows_; }
    void commit() { file_.commit(); }

  private:
    AtomicFile file_;
    std::size_t rows_ = 0;
};

}  // namespace coppice::cli
