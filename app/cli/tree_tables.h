#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "coppice/extract/plot/crown.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/mesh/mesh.h"
#include "csv_file.h"
#include "options.h"
#include "run.h"
#include "timber.h"

namespace coppice::cli {

/// Output files of the tables; empty where not requested.
struct TreeTableFlags {
    std::filesystem::path trees, branches, cylinders, taper;
    std::filesystem::path crowns;  ///< a mesh

    bool any() const;
};

void add_tree_table_options(OptionList& options, TreeTableFlags& flags);

/// Adds the sections of a stem to a table; each row begins with the given figures.
void add_taper(CsvFile& out, const Json& begin, const StemForm& form, LengthUnit units = LengthUnit::m);

/// Adds the hull of a crown to the others; all use the origin of the first one.
void add_hull(TriMesh& out, const TriMesh& hull);

/// Writes hulls as a stage of the run; warns and returns false if there are none.
bool write_crowns(Run& run, const std::filesystem::path& path, const TriMesh& hulls);

/// Tables with a row for each tree, branch, cylinder or stem section, and the crown hulls, of all files
/// added. The files appear on commit.
class TreeTables {
  public:
    /// Throws UsageError for names with unsupported extensions.
    TreeTables(const TreeTableFlags& flags, const TimberFlags& timber);

    /// Throws UsageError if the units of the file differ from those of earlier files.
    void add(Run& run, const std::string& path, int model, const SkeletonFile& file);
    /// Points have only stem sections and a crown.
    void add(const std::string& path, const StemForm& form, const Crown& crown);
    /// Writes the tables, warns of empty ones, and returns the written files.
    std::string commit(Run& run);

  private:
    void add_trees(const Json& begin, const SkeletonFile& file, const BranchTable& table,
                   std::span<const StemForm> forms, std::span<const double> bases,
                   std::span<const Crown> crowns);
    void add_branches(const Json& begin, const SkeletonFile& file, const BranchTable& table);
    void add_cylinders(const Json& begin, const SkeletonFile& file, const BranchTable& table);

    TreeTableFlags flags_;
    TimberFlags timber_;
    std::optional<LengthUnit> units_;  ///< units of all skeletons
    std::optional<CsvFile> trees_, branches_, cylinders_, taper_;
    TriMesh crowns_;
};

}  // namespace coppice::cli
