#include "coppice/system/file_lock.h"

#include <gtest/gtest.h>

#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

class FileLockTest : public test::FolderTest {};

TEST_F(FileLockTest, OneOwnerAtATime) {
    auto first = FileLock::try_lock(folder_ / "a.lock");
    EXPECT_TRUE(first);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "a.lock"));
    EXPECT_FALSE(FileLock::try_lock(folder_ / "a.lock"));
    EXPECT_TRUE(FileLock::try_lock(folder_ / "b.lock"));
    first.reset();
    EXPECT_TRUE(FileLock::try_lock(folder_ / "a.lock"));
}

TEST_F(FileLockTest, NamesTheFileThatCannotBeOpened) {
    const auto path = folder_ / "gone" / "a.lock";
    EXPECT_EQ(test::error_of<IoError>([&] { FileLock::try_lock(path); }),
              "cannot lock " + path.string() + ": there is no such file or folder");
}

}  // namespace
}  // namespace coppice
