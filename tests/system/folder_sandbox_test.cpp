#include "coppice/system/folder_sandbox.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>

#include "coppice/system/file.h"
#include "coppice/system/folder_sandbox_internal.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

template <class Action>
std::string error_of(const Action& action) {
    return test::error_of<IoError>(action);
}

/// A folder with files, and a secret outside that links lead to.
class FolderSandboxTest : public test::FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        folder_ = fs::canonical(folder_);
        home_ = folder_ / "home";
        fs::create_directories(home_ / "scans");
        put(folder_ / "secret.xyz");
        put(home_ / "tree.xyz");
        put(home_ / "scans" / "oak.xyz");
        put(home_ / ".hidden.xyz");
        fs::create_symlink(folder_ / "secret.xyz", home_ / "out.xyz");
        fs::create_symlink("../secret.xyz", home_ / "adjacent.xyz");
        fs::create_symlink(folder_, home_ / "way");
        fs::create_symlink("tree.xyz", home_ / "within.xyz");
        fs::create_symlink("nothing.xyz", home_ / "broken.xyz");
        fs::create_symlink("/proc/self/root", home_ / "magic");
        ASSERT_EQ(::mkfifo((home_ / "pipe.xyz").c_str(), 0600), 0);
    }
    static void put(const fs::path& path) { std::ofstream(path) << "0 0 0\n"; }

    fs::path home_;
};

const std::vector<std::string> kRefusedNames = {"",
                                                "/",
                                                "/etc/passwd",
                                                "..",
                                                "../secret.xyz",
                                                "scans/../../secret.xyz",
                                                "scans/..",
                                                "scans//x",
                                                "scans/",
                                                ".",
                                                "./",
                                                ".hidden.xyz",
                                                "scans/.hidden",
                                                "./../secret.xyz",
                                                "a\nb",
                                                "a\x7f",
                                                "\x1b[2J.xyz",
                                                "\xff.xyz",
                                                "\xc0\xaf",
                                                "\xed\xa0\x80",
                                                "\xf4\x90\x80\x80",
                                                "a\xe2\x82",
                                                ".../x",
                                                "..\\x",
                                                "//etc/passwd",
                                                std::string("a\0b", 3),
                                                std::string(1025, 'a')};

TEST_F(FolderSandboxTest, RejectsNamesThatLeaveTheFolderOrAreHidden) {
    const FolderSandbox sandbox(home_);
    for (const std::string& name : kRefusedNames) {
        SCOPED_TRACE(name);
        EXPECT_FALSE(system_internal::fault_of_name(name).empty());
        EXPECT_NE(error_of([&] { sandbox.to_read(name); }), "no error");
        EXPECT_NE(error_of([&] { sandbox.to_write(name); }), "no error");
        EXPECT_NE(error_of([&] { sandbox.open(name); }), "no error");
    }
    for (const char* name :
         {"a", "a.xyz", "a..b", "a/b", "./a", "a/./b", "\xc3\xa4.xyz", "\xf0\x9f\x8c\xb3", "a b"})
        EXPECT_EQ(system_internal::fault_of_name(name), "") << name;
}

TEST_F(FolderSandboxTest, FindsFilesInside) {
    const FolderSandbox sandbox(home_);
    EXPECT_EQ(sandbox.folder(), home_);
    EXPECT_EQ(sandbox.to_read("tree.xyz"), home_ / "tree.xyz");
    EXPECT_EQ(sandbox.to_read("./scans/oak.xyz"), home_ / "scans" / "oak.xyz");
    EXPECT_EQ(sandbox.to_read("scans"), home_ / "scans");
    EXPECT_EQ(sandbox.to_write("new.xyz"), home_ / "new.xyz");
    EXPECT_EQ(sandbox.to_write("scans/oak.xyz"), home_ / "scans" / "oak.xyz");
    const Descriptor file = sandbox.open("tree.xyz");
    char bytes[6] = {};
    EXPECT_EQ(::read(file.get(), bytes, 6), 6);
}

TEST_F(FolderSandboxTest, ErrorsReportTheReason) {
    const FolderSandbox sandbox(home_);
    EXPECT_EQ(error_of([&] { sandbox.to_read("../secret.xyz"); }),
              "cannot read '../secret.xyz': it is outside the opened folder");
    EXPECT_EQ(error_of([&] { sandbox.to_read("gone.xyz"); }),
              "cannot read 'gone.xyz': there is no such file or folder");
    EXPECT_EQ(error_of([&] { sandbox.to_write("gone/a.xyz"); }),
              "cannot write 'gone/a.xyz': its folder does not exist");
    EXPECT_EQ(error_of([&] { sandbox.to_write("tree.xyz/a.xyz"); }),
              "cannot write 'tree.xyz/a.xyz': a component of its path is not a folder");
    EXPECT_EQ(error_of([&] { sandbox.to_write("scans"); }),
              "cannot write 'scans': a folder or special file of this name exists");
    EXPECT_EQ(error_of([&] { sandbox.open("scans"); }), "cannot read 'scans': it is not a file");
    EXPECT_EQ(error_of([&] { sandbox.to_read("pipe.xyz"); }),
              "cannot read 'pipe.xyz': it is neither a file nor a folder");
    EXPECT_EQ(error_of([&] { FolderSandbox("gone"); }),
              "cannot open 'gone': there is no such file or folder");
}

TEST_F(FolderSandboxTest, DoesNotFollowSymbolicLinks) {
    const FolderSandbox sandbox(home_);
    for (const char* name : {"out.xyz", "adjacent.xyz", "way/secret.xyz", "way/home/tree.xyz", "within.xyz",
                             "broken.xyz", "magic/etc/passwd", "way"}) {
        SCOPED_TRACE(name);
        EXPECT_NE(error_of([&] { sandbox.to_read(name); }).find("symbolic links"), std::string::npos);
        EXPECT_NE(error_of([&] { sandbox.open(name); }).find("symbolic links"), std::string::npos);
        EXPECT_NE(error_of([&] { sandbox.to_write(name); }).find("symbolic links"), std::string::npos);
    }
}

TEST_F(FolderSandboxTest, StepwiseOpeningMatches) {
    const int folder = ::open(home_.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
    for (const char* name :
         {"tree.xyz", "scans", "scans/oak.xyz", "./tree.xyz", ".", "out.xyz", "adjacent.xyz",
          "way/secret.xyz", "within.xyz", "broken.xyz", "magic/etc/passwd", "gone", "gone/a", "tree.xyz/a"}) {
        SCOPED_TRACE(name);
        for (const int flags : {O_PATH | O_CLOEXEC, O_RDONLY | O_NONBLOCK | O_CLOEXEC}) {
            errno = 0;
            const int at_once = system_internal::open_beneath(folder, name, flags),
                      first = at_once < 0 ? errno : 0;
            errno = 0;
            const int stepwise = system_internal::open_stepwise(folder, name, flags),
                      then = stepwise < 0 ? errno : 0;
            EXPECT_EQ(at_once < 0, stepwise < 0);
            // A link in the middle is reported as a link by one, and as a component that is not a folder by
            // the other.
            if (first != ELOOP) {
                EXPECT_EQ(first, then);
            }
            struct stat a {
            }, b{};
            if (at_once >= 0 && ::fstat(at_once, &a) == 0 && ::fstat(stepwise, &b) == 0) {
                EXPECT_EQ(a.st_ino, b.st_ino);
            }
            if (at_once >= 0) ::close(at_once);
            if (stepwise >= 0) ::close(stepwise);
        }
    }
    ::close(folder);
}

TEST_F(FolderSandboxTest, AllowedFilesAreReadableButNotWritable) {
    const FolderSandbox sandbox(home_, {folder_ / "secret.xyz"});
    for (const std::string& name : {(folder_ / "secret.xyz").string(), std::string("../secret.xyz")}) {
        EXPECT_EQ(sandbox.to_read(name), folder_ / "secret.xyz");
        EXPECT_NE(error_of([&] { sandbox.to_write(name); }), "no error");
        EXPECT_NE(error_of([&] { sandbox.open(name); }), "no error");
    }
    EXPECT_NE(error_of([&] { sandbox.to_read("../secret.xyz.bak"); }), "no error");
    EXPECT_NE(error_of([&] { sandbox.to_read(folder_.string()); }), "no error");
}

}  // namespace
}  // namespace coppice
