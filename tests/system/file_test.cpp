#include "coppice/system/file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>

#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

class FileTest : public test::FolderTest {
  protected:
    std::size_t entries() const {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder_), fs::directory_iterator{}));
    }
    static void put(const fs::path& path, std::string_view text) {
        std::ofstream(path, std::ios::binary) << text;
    }
};

template <class Action>
std::string error_of(const Action& action) {
    return test::error_of<IoError>(action);
}

TEST_F(FileTest, ReadsFiles) {
    const std::string text("a\0b\r\n", 5);
    put(folder_ / "a", text);
    EXPECT_EQ(read_file(folder_ / "a"), text);
    EXPECT_EQ(read_file(folder_ / "a", 5), text);
    put(folder_ / "empty", "");
    EXPECT_EQ(read_file(folder_ / "empty"), "");
}

TEST_F(FileTest, ReadsFilesOfUnknownSize) {
    EXPECT_GT(read_file("/proc/self/status").size(), 100u);
    EXPECT_GT(read_file("/proc/self/status", UINT64_MAX).size(), 100u);
}

TEST_F(FileTest, ReadErrorsReportTheFileAndTheReason) {
    put(folder_ / "a", "12345");
    EXPECT_EQ(error_of([&] { read_file(folder_ / "b"); }),
              "cannot read " + (folder_ / "b").string() + ": there is no such file or folder");
    EXPECT_EQ(error_of([&] { read_file(folder_); }),
              "cannot read " + folder_.string() + ": it is a folder, not a file");
    EXPECT_EQ(error_of([&] { read_file(folder_ / "a", 4); }),
              "cannot read " + (folder_ / "a").string() + ": it is larger than 4 bytes");
    for (const char* endless : {"/proc/self/status", "/dev/zero"}) {
        EXPECT_EQ(error_of([&] { read_file(endless, 10); }),
                  std::string("cannot read ") + endless + ": it is larger than 10 bytes");
    }
    if (::geteuid() == 0) return;  // root may read everything
    fs::permissions(folder_ / "a", fs::perms::none);
    EXPECT_EQ(error_of([&] { read_file(folder_ / "a"); }),
              "cannot read " + (folder_ / "a").string() + ": permission denied");
}

TEST_F(FileTest, CreatesTheFileOnCommitOnly) {
    const std::string large(1 << 20, 'x');
    {
        AtomicFile file(folder_ / "a");
        file.write("head ");
        file.write(large);
        file.write(std::as_bytes(std::span("tail", 4)));
        EXPECT_FALSE(fs::exists(folder_ / "a"));
        file.commit();
    }
    EXPECT_EQ(read_file(folder_ / "a"), "head " + large + "tail");
    EXPECT_EQ(entries(), 1u);
}

// As when the process is killed: no destructor runs.
TEST_F(FileTest, WriteFileReplacesTheContent) {
    const std::string text("a\0b\r\n", 5);
    put(folder_ / "a", "before");
    write_file(folder_ / "a", text);
    EXPECT_EQ(read_file(folder_ / "a"), text);
    write_file(folder_ / "a", "");
    EXPECT_EQ(read_file(folder_ / "a"), "");
    EXPECT_EQ(entries(), 1u);
    EXPECT_NE(error_of([&] { write_file(folder_ / "no" / "a", text); }), "no error");
}

TEST_F(FileTest, UncommittedFileHasNoName) {
    AtomicFile file(folder_ / "a");
    file.write(std::string(1 << 20, 'x'));
#ifdef __linux__
    EXPECT_EQ(entries(), 0u);
#endif
    file.commit();
    EXPECT_EQ(entries(), 1u);
}

TEST_F(FileTest, ExceptionPreservesTheOldFile) {
    put(folder_ / "a", "old");
    try {
        AtomicFile file(folder_ / "a");
        file.write("new");
        throw std::runtime_error("stop");
    } catch (const std::runtime_error&) {
    }
    EXPECT_EQ(read_file(folder_ / "a"), "old");
    EXPECT_EQ(entries(), 1u);
}

TEST_F(FileTest, ConcurrentFilesDoNotMix) {
    AtomicFile a(folder_ / "a");
    AtomicFile b(folder_ / "a");
    a.write("first");
    b.write("second");
    a.commit();
    b.commit();
    EXPECT_EQ(read_file(folder_ / "a"), "second");
    EXPECT_EQ(entries(), 1u);
}

TEST_F(FileTest, PreservesPermissionsAndFollowsLinks) {
    put(folder_ / "a", "old");
    fs::permissions(folder_ / "a", static_cast<fs::perms>(0640));
    fs::create_symlink("a", folder_ / "link");
    AtomicFile file(folder_ / "link");
    file.write("new");
    file.commit();
    EXPECT_EQ(read_file(folder_ / "a"), "new");
    EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
    EXPECT_EQ(fs::status(folder_ / "a").permissions(), static_cast<fs::perms>(0640));
}

TEST_F(FileTest, NewFilesHaveTheDefaultPermissions) {
    put(folder_ / "usual", "");
    AtomicFile file(folder_ / "a");
    file.commit();
    EXPECT_EQ(fs::status(folder_ / "a").permissions(), fs::status(folder_ / "usual").permissions());
}

TEST_F(FileTest, DevicesAreWrittenAndNotReplaced) {
    AtomicFile file("/dev/null");
    file.write("gone");
    file.commit();
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(FileTest, WriteErrorsReportTheFileAndTheReason) {
    EXPECT_EQ(
        error_of([&] { AtomicFile file(folder_ / "no" / "a"); }),
        "cannot write " + (folder_ / "no" / "a").string() + ": its folder does not exist; create it first");
    EXPECT_EQ(error_of([&] { AtomicFile file(folder_); }),
              "cannot write " + folder_.string() + ": it is a folder, not a file");
    EXPECT_NE(error_of([&] { AtomicFile file(folder_ / ""); }).find("the path has no file name"),
              std::string::npos);
    EXPECT_NE(error_of([&] { AtomicFile file(""); }).find("the path has no file name"), std::string::npos);
    put(folder_ / "a", "");
    EXPECT_NE(error_of([&] { AtomicFile file(folder_ / "a" / "b"); }).find("is not a folder"),
              std::string::npos);
    EXPECT_NE(error_of([&] {
                  AtomicFile file(folder_ / std::string(300, 'n'));
                  file.commit();
              }).find("its name is too long"),
              std::string::npos);
    if (::geteuid() == 0) return;  // root may write everything
    fs::permissions(folder_ / "a", fs::perms::owner_read);
    EXPECT_NE(error_of([&] { AtomicFile file(folder_ / "a"); }).find("permission denied"), std::string::npos);
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_NE(error_of([&] { AtomicFile file(folder_ / "b"); }).find("its folder is not writable"),
              std::string::npos);
}

TEST_F(FileTest, AFullDiskIsAnError) {
    const auto fill = [] {
        AtomicFile file("/dev/full");
        file.write(std::string(1 << 20, 'x'));
        file.commit();
    };
    EXPECT_EQ(error_of(fill), "cannot write /dev/full: no space is left on the disk");
}

}  // namespace
}  // namespace coppice
