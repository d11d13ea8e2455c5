#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/compose/child_tree.h"

namespace coppice {

/// A child tree in a library.
struct LibraryEntry {
    std::int64_t id = 0;            ///< > 0; never reused after the tree was removed
    std::string source;             ///< name of the source file
    std::vector<std::string> tags;  ///< in alphabetical order
    ChildTreeMeasures measures;     ///< measures of the tree
    ChildTree tree;                 ///< its skeleton has no nodes if the entries were read without skeletons
};

/// Selects the trees of a library that satisfy all conditions.
struct LibraryFilter {
    std::vector<std::string> ids;   ///< any of these numbers; empty: all
    std::vector<std::string> tags;  ///< all of these tags
    std::vector<std::string> from;  ///< any of these sources; empty: all
    float min_length = 0;           ///< [m] minimum total length of the segments
    float max_length = 0;           ///< [m] maximum total length; 0: unlimited
    int min_orders = 0;             ///< minimum number of branch orders, see ChildTreeMeasures
    int max_orders = 0;             ///< maximum number of branch orders; 0: unlimited
    int min_tips = 0;               ///< minimum number of tips
    int max_tips = 0;               ///< maximum number of tips; 0: unlimited

    friend bool operator==(const LibraryFilter&, const LibraryFilter&) = default;  ///< memberwise
    bool empty() const { return *this == LibraryFilter{}; }  ///< whether all trees are selected
};

/// Lists the members for front ends.
void list_fields(LibraryFilter& o, FieldList& list);

/// Access mode of a library file.
enum class LibraryAccess {
    read,   ///< the file must exist
    write,  ///< the file must exist and be writable
    create  ///< writable, created if missing; a new file is removed again if no tree is added
};

/// A file of child trees: an SQLite database with two tables, `tree` and `tag`. Changes are atomic; they wait
/// up to a minute for other writers, so that no changes are lost.
///
/// All functions throw IoError with the file name if it is missing, not a library, damaged, of a newer
/// version, not writable or in use for too long; Cancelled.
class TreeLibrary {
  public:
    /// Cancellation of the context ends waiting and reading.
    TreeLibrary(const std::filesystem::path& path, LibraryAccess access, const Context& ctx = {});
    ~TreeLibrary();
    TreeLibrary(const TreeLibrary&) = delete;
    TreeLibrary& operator=(const TreeLibrary&) = delete;

    /// Result of `add`.
    struct Added {
        std::vector<std::int64_t> ids;  ///< numbers of the new trees, in order
        /// number of trees that the library already contained, bit-identical; they get the tags too
        std::uint32_t known = 0;
    };
    /// Trees from one file.
    struct Batch {
        std::span<const ChildTree> trees;  ///< branches of the file
        std::string source;                ///< name of the file
    };
    /// Adds the trees of all batches, or none if it throws. O(n log library).
    Added add(std::span<const Batch> batches, std::span<const std::string> tags);
    /// Adds the trees of one batch.
    Added add(std::span<const ChildTree> trees, const std::string& source, std::span<const std::string> tags);

    /// Returns the selected trees, sorted by number, without their skeletons. Throws InvalidInput if an id is
    /// not a number or there is no tree with it, and if the file contains values that no tree can have.
    std::vector<LibraryEntry> list(const LibraryFilter& filter) const;
    /// Returns the selected trees with their skeletons.
    std::vector<LibraryEntry> read(const LibraryFilter& filter) const;

    /// Removes the selected trees; returns their number.
    std::uint32_t remove(const LibraryFilter& filter);
    /// Adds and removes tags of the selected trees; returns the number of these trees.
    std::uint32_t tag(const LibraryFilter& filter, std::span<const std::string> add,
                      std::span<const std::string> take);

  private:
    class Database;
    std::unique_ptr<Database> database_;
};

/// Reads the selected trees of a library file, at least one. Throws like TreeLibrary, and InvalidInput if no
/// tree is selected.
std::vector<ChildTree> read_child_trees(const std::filesystem::path& path, const LibraryFilter& filter = {},
                                        const Context& ctx = {});

/// Formats entries as a table with a header line: number, measures, source and tags.
std::string make_table(std::span<const LibraryEntry> entries);

}  // namespace coppice
