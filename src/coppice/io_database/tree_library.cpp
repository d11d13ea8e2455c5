#include "coppice/io_database/tree_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/hash.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/quote.h"
#include "coppice/io_database/database_internal.h"
#include "coppice/io_database/skeleton_blob_internal.h"

namespace coppice {
namespace {

using namespace io_internal;

constexpr std::int64_t kApplication = 0x436f7063;  // "Copc"
constexpr std::int64_t kVersion = 1;
constexpr std::string_view kNoLibrary = "this is not a library of trees";
// These texts are compared with those of the file character by character: a file with other texts is not a
// library.
constexpr std::string_view kTreeTable = R"(CREATE TABLE tree (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    hash INTEGER NOT NULL UNIQUE,
    source TEXT NOT NULL,
    source_node INTEGER NOT NULL,
    leads INTEGER NOT NULL,
    host_radius REAL NOT NULL,
    inclination REAL NOT NULL,
    length REAL NOT NULL,
    volume REAL NOT NULL,
    extent REAL NOT NULL,
    nodes INTEGER NOT NULL,
    tips INTEGER NOT NULL,
    orders INTEGER NOT NULL,
    radius REAL NOT NULL,
    skeleton BLOB NOT NULL))";
constexpr std::string_view kTagTable = R"(CREATE TABLE tag (
    tree INTEGER NOT NULL REFERENCES tree (id) ON DELETE CASCADE,
    name TEXT NOT NULL,
    PRIMARY KEY (tree, name)) WITHOUT ROWID)";

std::int64_t compute_hash(const ChildTree& tree, std::span<const std::byte> blob) {
    Hash hash;
    hash.add(blob).add(tree.parent_radius).add(tree.inclination).add(std::uint32_t{tree.leads});
    return std::bit_cast<std::int64_t>(hash.value());
}

std::int64_t number(const Sqlite& database, const char* pragma) {
    Statement statement(database, pragma);
    return statement.step() ? statement.integer(0) : 0;
}

std::int64_t parse_id(const std::string& word) {
    std::int64_t id = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), id);
    if (error != std::errc{} || end != word.data() + word.size()) {
        throw InvalidInput(fmt::format(
            "{} is not the number of a tree; 'coppice library list LIBRARY' shows them", quote(word)));
    }
    return id;
}

bool within(double value, double least, double most) {
    return (least <= 0 || value >= least) && (most <= 0 || value <= most);
}

bool has(std::span<const std::string> all, const std::string& one) {
    return std::ranges::find(all, one) != all.end();
}

bool is_meant(const LibraryEntry& e, const LibraryFilter& f, std::span<const std::int64_t> ids) {
    const ChildTreeMeasures& m = e.measures;
    return (ids.empty() || std::ranges::find(ids, e.id) != ids.end()) &&
           (f.from.empty() || has(f.from, e.source)) &&
           std::ranges::all_of(f.tags, [&](const std::string& t) { return has(e.tags, t); }) &&
           within(m.length, double{f.min_length}, double{f.max_length}) &&
           within(m.orders, f.min_orders, f.max_orders) && within(m.tips, f.min_tips, f.max_tips);
}

void check_tags(std::span<const std::string> tags) {
    for (const std::string& tag : tags) {
        if (tag.empty() || tag.find_first_of(", \t\n") != std::string::npos)
            throw InvalidInput(fmt::format("{} is not a valid tag; use one word without commas", quote(tag)));
    }
}

}  // namespace

class TreeLibrary::Database : public Sqlite {
  public:
    using Sqlite::Sqlite;

    /// Removes a new file that is still empty while the open transaction keeps other programs from writing to
    /// it.
    ~Database() {
        std::error_code ignored;
        if (creation_ && was_empty_) std::filesystem::remove(path(), ignored);
    }
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    /// Runs change() in a transaction: that in which the tables of a new file were created, or a new one.
    template <class Change>
    void change(const Change& change) {
        if (!creation_) {
            Transaction all(*this);
            change();
            all.commit();
            return;
        }
        change();
        creation_->commit();
        creation_.reset();
    }

    /// Creates the tables of a new file; otherwise checks that it is a library of a supported version.
    void prepare(bool create) {
        execute("PRAGMA foreign_keys = ON");
        execute("PRAGMA trusted_schema = OFF");
        if (create && is_new()) make_tables();
        if (number(*this, "PRAGMA application_id") != kApplication) fail(kNoLibrary);
        const std::int64_t version = number(*this, "PRAGMA user_version");
        if (version != kVersion) {
            fail(fmt::format(
                "the library has version {}, but this program supports version {}; use a newer program",
                version, kVersion));
        }
        if (!has_our_tables()) fail(kNoLibrary);
    }

    /// Returns the selected trees in order of their numbers. If `checked`, throws InvalidInput for values
    /// that no tree can have.
    std::vector<LibraryEntry> entries(const LibraryFilter& filter, bool checked) const {
        std::vector<std::int64_t> ids;
        for (const std::string& word : filter.ids) ids.push_back(parse_id(word));
        Statement rows(
            *this,
            "SELECT id, source, source_node, leads, host_radius, inclination, length, volume, extent, "
            "nodes, tips, orders, radius FROM tree ORDER BY id");
        Statement tags(*this, "SELECT name FROM tag WHERE tree = ?1 ORDER BY name");
        std::vector<LibraryEntry> out;
        std::size_t known = 0;
        while (rows.step()) {
            if (checked && !is_valid(rows)) refuse_damaged(rows.integer(0));
            LibraryEntry entry = read_entry(rows);
            tags.bind(1, entry.id);
            while (tags.step()) entry.tags.push_back(tags.text(0));
            tags.reset();
            known += std::ranges::count(ids, entry.id);
            if (is_meant(entry, filter, ids)) out.push_back(std::move(entry));
        }
        if (known < ids.size()) refuse_unknown(ids);
        return out;
    }

    void load_skeletons(std::vector<LibraryEntry>& entries) const {
        Statement blobs(*this, "SELECT skeleton FROM tree WHERE id = ?1");
        for (LibraryEntry& e : entries) {
            throw_if_cancelled();
            blobs.bind(1, e.id);
            std::optional<Skeleton> skeleton;
            if (blobs.step()) skeleton = decode_blob(blobs.blob(0));
            blobs.reset();
            if (!skeleton || skeleton->size() < 2 || skeleton->tree_count() != 1 ||
                !std::isfinite(e.tree.inclination)) {
                refuse_damaged(e.id);
            }
            e.tree.skeleton = *std::move(skeleton);
        }
    }

    /// Adds the trees that the library does not contain yet, and adds the tags to all of them.
    void add(const Batch& batch, std::span<const std::string> tags, Added& out) const {
        Statement find(*this, "SELECT id FROM tree WHERE hash = ?1");
        Statement insert(
            *this,
            "INSERT INTO tree (hash, source, source_node, leads, host_radius, inclination, length, "
            "volume, extent, nodes, tips, orders, radius, skeleton) "
            "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14)");
        for (const ChildTree& tree : batch.trees) {
            throw_if_cancelled();
            const std::vector<std::byte> blob = encode_blob(tree.skeleton);
            const std::int64_t hash = compute_hash(tree, blob);
            find.bind(1, hash);
            std::int64_t id = find.step() ? find.integer(0) : 0;
            find.reset();
            if (id != 0) {
                ++out.known;
            } else {
                const ChildTreeMeasures m = measure(tree);
                insert.bind(1, hash);
                insert.bind(2, std::string_view(batch.source));
                insert.bind(3, std::int64_t{tree.source_node});
                insert.bind(4, std::int64_t{tree.leads});
                insert.bind(5, double{tree.parent_radius});
                insert.bind(6, double{tree.inclination});
                insert.bind(7, m.length);
                insert.bind(8, m.volume);
                insert.bind(9, m.extent);
                insert.bind(10, std::int64_t{m.nodes});
                insert.bind(11, std::int64_t{m.tips});
                insert.bind(12, std::int64_t{m.orders});
                insert.bind(13, double{m.radius});
                insert.bind(14, std::span<const std::byte>(blob));
                insert.run();
                id = sqlite3_last_insert_rowid(handle());
                out.ids.push_back(id);
            }
            add_tags(id, tags);
        }
    }

    void add_tags(std::int64_t tree, std::span<const std::string> tags) const {
        Statement insert(*this, "INSERT OR IGNORE INTO tag (tree, name) VALUES (?1, ?2)");
        for (const std::string& tag : tags) {
            insert.bind(1, tree);
            insert.bind(2, std::string_view(tag));
            insert.run();
        }
    }

  private:
    /// Keeps the transaction open until a tree is added.
    void make_tables() {
        creation_.emplace(*this);
        std::error_code missing;
        was_empty_ = std::filesystem::file_size(path(), missing) == 0;
        if (missing) fail("it has been removed by another program; try again");
        if (!is_new()) return creation_.reset();
        Statement(*this, kTreeTable).run();
        Statement(*this, kTagTable).run();
        execute(fmt::format("PRAGMA application_id = {}", kApplication).c_str());
        execute(fmt::format("PRAGMA user_version = {}", kVersion).c_str());
    }

    bool is_new() const {
        return number(*this, "PRAGMA application_id") == 0 &&
               number(*this, "SELECT count(*) FROM sqlite_master") == 0;
    }

    /// Returns whether the file contains the expected tables only, and no additional objects such as an
    /// endless view.
    bool has_our_tables() const {
        Statement schema(*this,
                         "SELECT count(*), total(sql IN (?1, ?2)) FROM sqlite_master "
                         "WHERE sql IS NOT NULL AND name != 'sqlite_sequence'");
        schema.bind(1, kTreeTable);
        schema.bind(2, kTagTable);
        return schema.step() && schema.integer(0) == 2 && schema.integer(1) == 2;
    }

    static LibraryEntry read_entry(const Statement& row) {
        const auto count = [&](int column) { return static_cast<std::uint32_t>(row.integer(column)); };
        return {.id = row.integer(0),
                .source = row.text(1),
                .tags = {},
                .measures = {.length = row.real(6),
                             .volume = row.real(7),
                             .extent = row.real(8),
                             .nodes = count(9),
                             .tips = count(10),
                             .orders = count(11),
                             .radius = static_cast<float>(row.real(12))},
                .tree = {.skeleton = {},
                         .parent_radius = static_cast<float>(row.real(4)),
                         .inclination = static_cast<float>(row.real(5)),
                         .leads = row.integer(3) != 0,
                         .source_node = count(2)}};
    }

    /// Returns whether the row contains values that `add` could have written. Any program may have written
    /// the file, and SQLite stores values of any type in any column.
    static bool is_valid(const Statement& row) {
        const auto counts = [&](int column, std::int64_t low, std::int64_t high) {
            return row.type(column) == SQLITE_INTEGER && row.integer(column) >= low &&
                   row.integer(column) <= high;
        };
        const auto measures = [&](int column) {
            return row.type(column) == SQLITE_FLOAT && std::isfinite(static_cast<float>(row.real(column)));
        };
        constexpr std::int64_t kMaxCount = std::numeric_limits<std::uint32_t>::max();
        constexpr std::array kLengths{4, 6, 7, 8, 12};
        return counts(0, 1, std::numeric_limits<std::int64_t>::max()) && row.type(1) == SQLITE_TEXT &&
               counts(2, 0, kMaxCount) && counts(3, 0, 1) && counts(9, 2, kMaxCount) &&
               counts(10, 1, kMaxCount) && counts(11, 1, kMaxCount) && measures(5) &&
               std::ranges::all_of(kLengths,
                                   [&](int column) { return measures(column) && row.real(column) >= 0; });
    }

    [[noreturn]] void refuse_damaged(std::int64_t id) const {
        throw InvalidInput(
            fmt::format("{0}: tree {1} is damaged; remove it with 'coppice library remove {0} --id {1}'",
                        path().string(), id));
    }

    [[noreturn]] void refuse_unknown(std::span<const std::int64_t> ids) const {
        Statement one(*this, "SELECT count(*) FROM tree WHERE id = ?1");
        for (const std::int64_t id : ids) {
            one.bind(1, id);
            const bool found = one.step() && one.integer(0) > 0;
            one.reset();
            if (!found)
                throw InvalidInput(
                    fmt::format("{}: there is no tree {}; 'coppice library list {}' shows them",
                                path().string(), id, path().string()));
        }
        throw InvalidInput(fmt::format("{}: a tree is listed twice", path().string()));
    }

    std::optional<Transaction> creation_;  ///< transaction of a new file, open until a tree is added
    bool was_empty_ = false;               ///< whether the file was empty when that transaction began
};

TreeLibrary::TreeLibrary(const std::filesystem::path& path, LibraryAccess access, const Context& ctx) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        throw IoError(fmt::format("{}: this is a folder; specify a file", path.string()));
    if (access != LibraryAccess::create && !std::filesystem::exists(path, ignored)) {
        throw IoError(
            fmt::format("{}: there is no such file; 'coppice library add {} TREE' creates a library",
                        path.string(), path.string()));
    }
    const int flags = access == LibraryAccess::read    ? SQLITE_OPEN_READONLY
                      : access == LibraryAccess::write ? SQLITE_OPEN_READWRITE
                                                       : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
    database_ = std::make_unique<Database>(path, flags, ctx);
    database_->prepare(access == LibraryAccess::create);
}

TreeLibrary::~TreeLibrary() = default;

TreeLibrary::Added TreeLibrary::add(std::span<const ChildTree> trees, const std::string& source,
                                    std::span<const std::string> tags) {
    const Batch batch{trees, source};
    return add({&batch, 1}, tags);
}

TreeLibrary::Added TreeLibrary::add(std::span<const Batch> batches, std::span<const std::string> tags) {
    check_tags(tags);
    Added out;
    database_->change([&] {
        for (const Batch& batch : batches) database_->add(batch, tags, out);
    });
    return out;
}

std::vector<LibraryEntry> TreeLibrary::list(const LibraryFilter& filter) const {
    check_fields(filter, "library");
    return database_->entries(filter, true);
}

std::vector<LibraryEntry> TreeLibrary::read(const LibraryFilter& filter) const {
    std::vector<LibraryEntry> out = list(filter);
    database_->load_skeletons(out);
    return out;
}

std::uint32_t TreeLibrary::remove(const LibraryFilter& filter) {
    check_fields(filter, "library");
    std::uint32_t removed = 0;
    database_->change([&] {
        Statement remove(*database_, "DELETE FROM tree WHERE id = ?1");
        for (const LibraryEntry& e : database_->entries(filter, false)) {
            remove.bind(1, e.id);
            remove.run();
            ++removed;
        }
    });
    return removed;
}

std::uint32_t TreeLibrary::tag(const LibraryFilter& filter, std::span<const std::string> add,
                               std::span<const std::string> take) {
    check_fields(filter, "library");
    check_tags(add);
    std::uint32_t tagged = 0;
    database_->change([&] {
        Statement remove(*database_, "DELETE FROM tag WHERE tree = ?1 AND name = ?2");
        for (const LibraryEntry& e : database_->entries(filter, false)) {
            for (const std::string& tag : take) {
                remove.bind(1, e.id);
                remove.bind(2, std::string_view(tag));
                remove.run();
            }
            database_->add_tags(e.id, add);
            ++tagged;
        }
    });
    return tagged;
}

std::vector<ChildTree> read_child_trees(const std::filesystem::path& path, const LibraryFilter& filter,
                                        const Context& ctx) {
    std::vector<ChildTree> trees;
    for (LibraryEntry& e : TreeLibrary(path, LibraryAccess::read, ctx).read(filter))
        trees.push_back(std::move(e.tree));
    if (trees.empty()) throw InvalidInput(fmt::format("{}: there are no such trees", path.string()));
    return trees;
}

std::string make_table(std::span<const LibraryEntry> entries) {
    std::string text = fmt::format("{:>6} {:>10} {:>10} {:>9} {:>6} {:>6} {:>8} {:>8} {:>5} {:>5}  {}\n",
                                   "id", "length m", "volume l", "extent m", "nodes", "tips", "orders",
                                   "radius", "incl", "leads", "source, tags");
    for (const LibraryEntry& e : entries) {
        const ChildTreeMeasures& m = e.measures;
        text += fmt::format(
            "{:>6} {:>10.3f} {:>10.4f} {:>9.3f} {:>6} {:>6} {:>8} {:>8.4f} {:>5.0f} {:>5}  {}{}{}\n", e.id,
            m.length, 1000 * m.volume, m.extent, m.nodes, m.tips, m.orders, double{m.radius},
            double{e.tree.inclination} * 180 / std::numbers::pi, e.tree.leads ? "yes" : "no",
            printable(e.source), e.tags.empty() ? "" : ", ",
            printable(fmt::format("{}", fmt::join(e.tags, ", "))));
    }
    return text;
}

void list_fields(LibraryFilter& o, FieldList& list) {
    list.add(common_field("ids", "Select the tree with this number; may be repeated."), o.ids);
    list.add(common_field("tags", "Select trees with this tag; if repeated, trees with all of the tags."),
             o.tags);
    list.add(
        common_field("from", "Select trees from this source file, named as in the list; may be repeated."),
        o.from);
    list.add(Field{"min_tree_length", "Minimum total length of the segments of a tree.", Unit::metre, 0, 1e9},
             o.min_length);
    list.add(Field{"max_tree_length", "Maximum total length of the segments of a tree; 0 means unlimited.",
                   Unit::metre, 0, 1e9},
             o.max_length);
    list.add(
        Field{"min_orders", "Minimum number of branch orders of a tree; 1 means a tree without laterals.",
              Unit::none, 0, 1e6},
        o.min_orders);
    list.add(Field{"max_orders", "Maximum number of branch orders of a tree; 0 means unlimited.", Unit::none,
                   0, 1e6},
             o.max_orders);
    list.add(Field{"min_tips", "Minimum number of tips of a tree.", Unit::none, 0, 1e9}, o.min_tips);
    list.add(Field{"max_tips", "Maximum number of tips of a tree; 0 means unlimited.", Unit::none, 0, 1e9},
             o.max_tips);
}

}  // namespace coppice
