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
    std::int64_t id = 0;            ///< > 0; never used again after it was removed
    std::string source;             ///< the file that it is from
    std::vector<std::string> tags;  ///< by the alphabet
    ChildTreeMeasures measures;     ///< of the tree
    ChildTree tree;  ///< without a skeleton's worth, one node, where only the list was asked for
};

/// Which trees of a library are meant: those that all of it holds for.
struct LibraryFilter {
    std::vector<std::string> ids;   ///< any of these; empty = all
    std::vector<std::string> tags;  ///< all of these
    std::vector<std::string> from;  ///< any of these sources; empty = all
    float least_length = 0;         ///< [m] of all segments
    float most_length = 0;          ///< [m] 0 = any
    int least_orders = 0;           ///< as in ChildTreeMeasures
    int most_orders = 0;            ///< 0 = any
    int least_tips = 0;             ///< number of tips
    int most_tips = 0;              ///< 0 = any

    friend bool operator==(const LibraryFilter&, const LibraryFilter&) = default;  ///< member by member
    bool empty() const { return *this == LibraryFilter{}; }  ///< whether all trees are meant
};

template <class Self, class Visitor>
requires SameOptions<Self, LibraryFilter>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("ids", "Select the tree with this number; may be repeated"), o.ids);
    visit(common_field("tags", "Select trees with this tag; if repeated, trees with all of the tags"),
          o.tags);
    visit(common_field("from", "Select trees from this source file, named as in the list; may be repeated"),
          o.from);
    visit(Field{"least_length", "trees whose segments are together as long as this", Unit::metre, 0, 1e9},
          o.least_length);
    visit(Field{"most_length", "trees that are no longer; 0 = any", Unit::metre, 0, 1e9}, o.most_length);
    visit(
        Field{"least_orders", "trees with as many orders of branches, 1 has no laterals", Unit::none, 0, 1e6},
        o.least_orders);
    visit(Field{"most_orders", "trees with no more orders; 0 = any", Unit::none, 0, 1e6}, o.most_orders);
    visit(Field{"least_tips", "trees with as many tips", Unit::none, 0, 1e9}, o.least_tips);
    visit(Field{"most_tips", "trees with no more tips; 0 = any", Unit::none, 0, 1e9}, o.most_tips);
}

/// How a library file is opened.
enum class LibraryAccess {
    read,   ///< it has to be there
    write,  ///< the same, to change it
    create  ///< the same, and made where it is missing; nothing stays of it where nothing is added
};

/// A file of child trees: an SQLite database of two tables, `tree` and `tag`. Every change happens whole or
/// not at all, and waits up to a minute for other writers, so that nobody's changes are lost.
///
/// All functions throw IoError naming the file where it is missing, no library, damaged, of a later version,
/// not writable or in use for too long; Cancelled.
class TreeLibrary {
  public:
    /// Context::stop ends waiting and reading.
    TreeLibrary(const std::filesystem::path& path, LibraryAccess access, const Context& ctx = {});
    ~TreeLibrary();
    TreeLibrary(const TreeLibrary&) = delete;
    TreeLibrary& operator=(const TreeLibrary&) = delete;

    /// What `add` did.
    struct Added {
        std::vector<std::int64_t> ids;  ///< of the new ones, in order
        std::uint32_t known = 0;        ///< that were there already, bit by bit; they get the tags too
    };
    /// Trees that are from one file.
    struct Batch {
        std::span<const ChildTree> trees;  ///< its branches
        std::string source;                ///< the file
    };
    /// Adds the trees of all batches, or none of them where it throws. O(n log library).
    Added add(std::span<const Batch> batches, std::span<const std::string> tags);
    /// The same for one batch.
    Added add(std::span<const ChildTree> trees, const std::string& source, std::span<const std::string> tags);

    /// The trees meant, by their numbers, without their skeletons. Throws InvalidInput where an id is no
    /// number or names none, and where the file holds values that no tree has.
    std::vector<LibraryEntry> list(const LibraryFilter& filter) const;
    /// The same with their skeletons.
    std::vector<LibraryEntry> read(const LibraryFilter& filter) const;

    /// Removes trees; returns how many.
    std::uint32_t remove(const LibraryFilter& filter);
    /// Gives trees tags, and takes tags away; returns how many trees were meant.
    std::uint32_t tag(const LibraryFilter& filter, std::span<const std::string> add,
                      std::span<const std::string> take);

  private:
    class Database;
    std::unique_ptr<Database> database_;
};

/// The trees of a library file that are meant, at least one. Throws as TreeLibrary does, and InvalidInput
/// where there is none.
std::vector<ChildTree> read_child_trees(const std::filesystem::path& path, const LibraryFilter& filter = {},
                                        const Context& ctx = {});

/// What trees are like, as lines of columns under a heading: number, measures, source and tags.
std::string table_of(std::span<const LibraryEntry> entries);

}  // namespace coppice
