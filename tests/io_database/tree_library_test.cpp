#include "coppice/io_database/tree_library.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "coppice/skeleton/random_tree.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

using test::error_of;

class TreeLibraryTest : public test::FolderTest {
  protected:
    std::filesystem::path file() const { return folder_ / "oak.coppicelib"; }

    /// Fills the library; returns its entries.
    std::vector<ChildTree> fill(const std::vector<std::string>& tags = {}) const {
        std::vector<ChildTree> trees = child_trees(random_tree(60, 1));
        TreeLibrary(file(), LibraryAccess::create).add(trees, "oak.swc", tags);
        return trees;
    }
    /// Runs SQL on it, as another program might.
    void execute(const char* sql) const {
        sqlite3* handle = nullptr;
        sqlite3_open(file().c_str(), &handle);
        EXPECT_EQ(sqlite3_exec(handle, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(handle);
        sqlite3_close(handle);
    }
    std::vector<LibraryEntry> read(const LibraryFilter& filter = {}) const {
        return TreeLibrary(file(), LibraryAccess::read).read(filter);
    }
    template <class E = IoError>
    void expect_refused(std::string_view what) const {
        const std::string message = error_of<E>([&] { read(); });
        EXPECT_NE(message.find(what), std::string::npos) << message;
        EXPECT_NE(message.find("oak.coppicelib"), std::string::npos) << message;
    }
};

TEST_F(TreeLibraryTest, ReturnsTheAddedTrees) {
    const std::vector<ChildTree> trees = fill({"oak", "young"});
    const std::vector<LibraryEntry> entries = read();
    ASSERT_EQ(entries.size(), trees.size());
    for (std::size_t i = 0; i < trees.size(); ++i) {
        const ChildTree &a = trees[i], &b = entries[i].tree;
        EXPECT_TRUE(std::ranges::equal(a.skeleton.parents(), b.skeleton.parents()));
        EXPECT_TRUE(std::ranges::equal(a.skeleton.positions(), b.skeleton.positions()));
        EXPECT_TRUE(std::ranges::equal(a.skeleton.radii(), b.skeleton.radii()));
        EXPECT_EQ(a.parent_radius, b.parent_radius);
        EXPECT_EQ(a.inclination, b.inclination);
        EXPECT_EQ(a.leads, b.leads);
        EXPECT_EQ(a.source_node, b.source_node);
        EXPECT_EQ(entries[i].source, "oak.swc");
        EXPECT_EQ(entries[i].tags, (std::vector<std::string>{"oak", "young"}));
        const ChildTreeMeasures m = measure(a);
        EXPECT_EQ(entries[i].measures.length, m.length);
        EXPECT_EQ(entries[i].measures.tips, m.tips);
        EXPECT_EQ(entries[i].measures.orders, m.orders);
    }
}

TEST_F(TreeLibraryTest, ContainsNoDuplicates) {
    const std::vector<ChildTree> trees = fill();
    TreeLibrary library(file(), LibraryAccess::write);
    const TreeLibrary::Added again = library.add(trees, "copy.swc", std::vector<std::string>{"late"});
    EXPECT_EQ(again.known, trees.size());
    EXPECT_TRUE(again.ids.empty());
    EXPECT_EQ(library.list({.tags = {"late"}}).size(), trees.size());
}

TEST_F(TreeLibraryTest, FiltersTagsAndRemovesTrees) {
    const std::vector<ChildTree> trees = fill({"oak"});
    TreeLibrary library(file(), LibraryAccess::write);
    const auto longest = library.list({.min_length = 1.0f});
    ASSERT_GT(longest.size(), 0u);
    ASSERT_LT(longest.size(), trees.size());
    for (const LibraryEntry& e : longest) EXPECT_GE(e.measures.length, 1);
    for (const LibraryEntry& e : library.list({.max_orders = 1})) EXPECT_EQ(e.measures.orders, 1u);
    EXPECT_EQ(library.list({.from = {"elm.swc"}}).size(), 0u);
    const std::string id = std::to_string(longest[0].id);
    EXPECT_EQ(library.tag({.ids = {id}}, std::vector<std::string>{"best"}, std::vector<std::string>{"oak"}),
              1u);
    EXPECT_EQ(library.list({.tags = {"oak"}}).size(), trees.size() - 1);
    EXPECT_EQ(library.list({.tags = {"best"}})[0].id, longest[0].id);
    EXPECT_EQ(library.remove({.tags = {"best"}}), 1u);
    EXPECT_EQ(library.list({}).size(), trees.size() - 1);
    const std::string message = error_of([&] { library.list({.ids = {id}}); });
    EXPECT_NE(message.find("there is no tree " + id), std::string::npos) << message;
    EXPECT_NE(error_of([&] { library.list({.ids = {"x7"}}); }).find("'x7'"), std::string::npos);
    EXPECT_NE(error_of([&] { library.tag({}, std::vector<std::string>{"a b"}, {}); }).find("tag"),
              std::string::npos);
}

TEST_F(TreeLibraryTest, ConcurrentWritersLoseNothing) {
    fill();
    const std::size_t before = read().size();
    std::vector<std::thread> writers;
    for (std::uint64_t w = 0; w < 2; ++w) {
        writers.emplace_back([&, w] {
            for (std::uint64_t i = 0; i < 10; ++i) {
                TreeLibrary library(file(), LibraryAccess::write);
                library.add(child_trees(random_tree(20, 100 * w + i + 10)), std::to_string(w), {});
            }
        });
    }
    for (std::thread& t : writers) t.join();
    std::size_t expected = before;
    for (std::uint64_t w = 0; w < 2; ++w) {
        for (std::uint64_t i = 0; i < 10; ++i)
            expected += child_trees(random_tree(20, 100 * w + i + 10)).size();
    }
    EXPECT_EQ(read().size(), expected);
}

TEST_F(TreeLibraryTest, RejectsFilesThatAreNotLibraries) {
    EXPECT_NE(error_of<IoError>([&] { read(); }).find("no such file"), std::string::npos);
    std::ofstream(file()) << "not a database, but long enough to be looked at as one "
                          << std::string(2000, 'x');
    expect_refused("not a library");
    EXPECT_NE(error_of<IoError>([&] { TreeLibrary(file(), LibraryAccess::create); }).find("not a library"),
              std::string::npos);
    std::filesystem::remove(file());
    execute("CREATE TABLE other (x)");
    expect_refused("not a library");
    EXPECT_NE(error_of<IoError>([&] { TreeLibrary(folder_, LibraryAccess::read); }).find("folder"),
              std::string::npos);
}

TEST_F(TreeLibraryTest, RejectsOtherVersionsViewsAndDamage) {
    fill();
    execute("PRAGMA user_version = 2");
    expect_refused("version 2");
    execute("PRAGMA user_version = 1");
    EXPECT_GT(read().size(), 0u);
    execute("CREATE VIEW more AS SELECT 1");
    expect_refused("not a library");
    execute("DROP VIEW more");
    execute("UPDATE tree SET skeleton = x'0100' WHERE id = 3");
    expect_refused<InvalidInput>("tree 3 is damaged");
    EXPECT_EQ(TreeLibrary(file(), LibraryAccess::write).remove({.ids = {"3"}}), 1u);
    execute("UPDATE tree SET inclination = 9e999 WHERE id = 4");
    expect_refused<InvalidInput>("tree 4 is damaged");
    EXPECT_EQ(TreeLibrary(file(), LibraryAccess::write).remove({.ids = {"4"}}), 1u);
    EXPECT_GT(read().size(), 0u);
}

TEST_F(TreeLibraryTest, RejectsInvalidValues) {
    fill();
    for (const char* value :
         {"nodes = -1", "tips = 'many'", "orders = 0", "length = -2", "volume = 9e999", "radius = x'00'",
          "host_radius = 1e300", "source = x'41'", "source_node = 5000000000", "leads = 2"}) {
        std::filesystem::copy_file(file(), folder_ / "whole");
        execute(("UPDATE tree SET " + std::string(value) + " WHERE id = 2").c_str());
        expect_refused<InvalidInput>("tree 2 is damaged; remove it with");
        EXPECT_EQ(TreeLibrary(file(), LibraryAccess::write).remove({.ids = {"2"}}), 1u) << value;
        EXPECT_GT(read().size(), 0u);
        std::filesystem::rename(folder_ / "whole", file());
    }
    execute("UPDATE tree SET id = -7 WHERE id = 2");
    expect_refused<InvalidInput>("tree -7 is damaged");
    EXPECT_EQ(TreeLibrary(file(), LibraryAccess::write).remove({.ids = {"-7"}}), 1u);
}

TEST_F(TreeLibraryTest, EscapesControlCharactersInLists) {
    fill({"oak"});
    execute(
        "UPDATE tree SET source = 'a' || char(27) || '[2J' || char(10) || 'b'; UPDATE tag SET name = "
        "char(7)");
    const std::string table = make_table(TreeLibrary(file(), LibraryAccess::read).list({}));
    EXPECT_NE(table.find("a\\x1b[2J\\nb, \\x07\n"), std::string::npos) << table;
    EXPECT_EQ(table.find('\x1b'), std::string::npos);
}

TEST_F(TreeLibraryTest, CreatesNoFileIfNothingIsAdded) {
    const std::vector<ChildTree> trees = child_trees(random_tree(60, 1));
    const std::vector<std::string> bad{"a b"};
    EXPECT_THROW(TreeLibrary(file(), LibraryAccess::create).add(trees, "oak.swc", bad), InvalidInput);
    std::stop_source stopped;
    stopped.request_stop();
    EXPECT_THROW(
        TreeLibrary(file(), LibraryAccess::create, {.stop = stopped.get_token()}).add(trees, "oak.swc", {}),
        Cancelled);
    { const TreeLibrary unused(file(), LibraryAccess::create); }
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
    // Adding an empty list of trees succeeds: the library is empty.
    TreeLibrary(file(), LibraryAccess::create).add({}, "oak.swc", {});
    EXPECT_EQ(read().size(), 0u);
    EXPECT_THROW(TreeLibrary(file(), LibraryAccess::create).add(trees, "oak.swc", bad), InvalidInput);
    EXPECT_EQ(read().size(), 0u);
}

TEST_F(TreeLibraryTest, AddsAllBatchesTogether) {
    const std::vector<ChildTree> trees = child_trees(random_tree(60, 1));
    std::vector<ChildTree> others = child_trees(random_tree(30, 2));
    const std::vector<TreeLibrary::Batch> batches{{trees, "a.swc"}, {others, "b.swc"}};
    const auto added = TreeLibrary(file(), LibraryAccess::create).add(batches, {});
    EXPECT_EQ(added.ids.size(), trees.size() + others.size());
    EXPECT_EQ(TreeLibrary(file(), LibraryAccess::read).list({.from = {"b.swc"}}).size(), others.size());
}

TEST_F(TreeLibraryTest, RejectsATruncatedFile) {
    fill();
    std::filesystem::resize_file(file(), std::filesystem::file_size(file()) / 2);
    const std::string message = error_of<IoError>([&] { read(); });
    EXPECT_NE(message.find("damaged"), std::string::npos) << message;
}

}  // namespace
}  // namespace coppice
