#include "journal.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>

#include "launch.h"
#include "temporary_folder.h"

#include "coppice/system/file.h"

namespace coppice::server {
namespace {

class Journal : public test::FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        ::setenv("XDG_STATE_HOME", folder_.c_str(), 1);
        ::setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
    }
    void TearDown() override {
        ::unsetenv("XDG_STATE_HOME");
        ::unsetenv("XDG_RUNTIME_DIR");
        FolderTest::TearDown();
    }
};

TEST_F(Journal, IsReusedByTheNextStudioOfTheDocument) {
    std::filesystem::path first;
    {
        const JournalPlace place("a/tree.coppice");
        first = place.file();
        ASSERT_FALSE(first.empty());
        write_file(first, "sphere s\n");
        const JournalPlace adjacent("a/tree.coppice"), other("a/other.coppice");
        EXPECT_NE(adjacent.file(), first);  // locked by the one above
        EXPECT_NE(other.file(), first);
        EXPECT_NE(other.file(), adjacent.file());
    }
    EXPECT_EQ(JournalPlace("a/tree.coppice").file(), first);
    EXPECT_EQ(JournalPlace("a/./b/../tree.coppice").file(), first);
    EXPECT_EQ(read_file(first), "sphere s\n");
}

TEST_F(Journal, IsEmptyWithoutAWritableFolder) {
    ::setenv("XDG_STATE_HOME", "/proc/none", 1);
    EXPECT_TRUE(JournalPlace("tree.coppice").file().empty());
}

TEST_F(Journal, DoorwayIsReadableByItsOwnerOnly) {
    std::filesystem::path file;
    {
        const Doorway doorway("http://127.0.0.1:1/#token=abc");
        file = doorway.file();
        using std::filesystem::perms;
        EXPECT_EQ(std::filesystem::status(file).permissions(), perms::owner_read | perms::owner_write);
        EXPECT_EQ(file.parent_path(), folder_);
        EXPECT_NE(read_file(file).find("url=http://127.0.0.1:1/#token=abc"), std::string::npos);
    }
    EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace coppice::server
