#include "coppice/io_database/batch_journal.h"

#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "coppice/base/error.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

class BatchJournalTest : public test::FolderTest {
  protected:
    std::filesystem::path file() const { return folder_ / "journal.sqlite"; }
};

TEST_F(BatchJournalTest, EntriesRemainInTheFile) {
    constexpr std::uint64_t kState = 0xfedcba9876543210;
    BatchJournal(file()).record({"oak.ply", kState, "{}"});
    const auto entry = BatchJournal(file()).find("oak.ply");
    ASSERT_TRUE(entry);
    EXPECT_EQ(entry->state, kState);
    EXPECT_EQ(entry->row, "{}");
    EXPECT_FALSE(BatchJournal(file()).find("elm.ply"));
}

TEST_F(BatchJournalTest, RecordReplacesTheEntryOfTheSameResult) {
    BatchJournal journal(file());
    journal.record({"oak.ply", 1, "a"});
    journal.record({"oak.ply", 2, "b"});
    EXPECT_EQ(journal.find("oak.ply")->row, "b");
}

TEST_F(BatchJournalTest, RemoveIgnoresUnknownResults) {
    BatchJournal journal(file());
    journal.record({"oak.ply", 1, ""});
    journal.record({"elm.ply", 1, ""});
    const std::vector<std::string> outputs{"oak.ply", "ash.ply"};
    journal.remove(outputs);
    EXPECT_FALSE(journal.find("oak.ply"));
    EXPECT_TRUE(journal.find("elm.ply"));
}

TEST_F(BatchJournalTest, OtherFilesAreRefused) {
    std::ofstream(file()) << "a text that is longer than the header of a database, and no database\n"
                          << std::string(200, 'x');
    EXPECT_NE(test::error_of<IoError>([&] { BatchJournal journal(file()); }).find("not a journal of a batch"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice
