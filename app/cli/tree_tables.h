#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "coppice/extract/plot/crown.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/io/skeleton/reader.h"
#include "coppice/mesh/mesh.h"
#include "csv_file.h"
#include "options.h"
#include "run.h"
#include "timber.h"

namespace coppice::cli {

/// Where tables of what files consist of go; none where nothing is named.
struct TreeTableFlags {
    std::filesystem::path trees, branches, cylinders, taper;
    std::filesystem::path crowns;  ///< a mesh

    bool any() const;
};

void add_tree_table_options(OptionList& options, TreeTableFlags& flags);

/// Adds the sections of a stem to a table, each row beginning with those figures.
void add_taper(CsvFile& out, const Figures& begin, const StemForm& form, LengthUnit units = LengthUnit::m);

/// Adds the hull of a crown to those of others; the first one's origin is that of all.
void add_hull(TriMesh& out, const TriMesh& hull);

/// Writes hulls as a stage of the run; warns, and returns false, where there are none.
bool write_crowns(Run& run, const std::filesystem::path& path, const TriMesh& hulls);

/// Tables with a row for each tree, branch, cylinder or section of a stem, and the hulls of the crowns, of
/// all files that are added. Everything appears when it is committed.
class TreeTables {
  public:
    /// Throws UsageError for names that are none of what is to be written.
    TreeTables(const TreeTableFlags& flags, const TimberFlags& timber);

    /// Throws UsageError where the file is in other units than those before it.
    void add(Run& run, const std::string& path, int model, const SkeletonFile& file);
    /// Of points there are only the sections of their stem, and a crown.
    void add(const std::string& path, const StemForm& form, const Crown& crown);
    /// Writes what there is, warns of what there is nothing of, and returns what was written.
    std::string commit(Run& run);

  private:
    void check_units(const std::string& path, LengthUnit units);
    void add_trees(const Figures& begin, const SkeletonFile& file, const BranchTable& table,
                   std::span<const StemForm> forms, std::span<const double> bases,
                   std::span<const Crown> crowns);
    void add_branches(const Figures& begin, const SkeletonFile& file, const BranchTable& table);
    void add_cylinders(const Figures& begin, const SkeletonFile& file, const BranchTable& table);

    TreeTableFlags flags_;
    TimberFlags timber_;
    std::optional<LengthUnit> units_;  ///< of all skeletons
    std::optional<CsvFile> trees_, branches_, cylinders_, taper_;
    TriMesh crowns_;
};

}  // namespace coppice::cli
