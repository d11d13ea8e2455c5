#include "coppice/system/program.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include "coppice/base/error.h"

namespace coppice {
namespace {

/// Output of a program and its status.
std::pair<std::string, int> printed(ProgramStart start) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe(ends.data()), 0);
    start.output = ends[1];
    const pid_t program = start_program(start);
    ::close(ends[1]);
    std::string out;
    std::array<char, 256> piece{};
    for (ssize_t n = 0; (n = ::read(ends[0], piece.data(), piece.size())) > 0;)
        out.append(piece.data(), static_cast<std::size_t>(n));
    ::close(ends[0]);
    return {out, wait_for_program(program)};
}

std::string path_of(std::string_view name) { return find_program(name).value().string(); }

TEST(Program, IsFoundByItsNameInAbsoluteFoldersAlone) {
    EXPECT_TRUE(find_program("sh"));
    EXPECT_TRUE(find_program("sh")->is_absolute());
    EXPECT_FALSE(find_program("no-such-program-anywhere"));
    EXPECT_FALSE(find_program("./sh"));
    EXPECT_FALSE(find_program(""));
    EXPECT_FALSE(find_program("/"));
}

TEST(Program, GetsItsWordsAsTheyAre) {
    const auto [text, status] = printed({.words = {path_of("echo"), "a b", "$HOME", "*"}});
    EXPECT_EQ(text, "a b $HOME *\n");
    EXPECT_EQ(status, 0);
}

TEST(Program, HasTheEnvironmentThatItIsGiven) {
    EXPECT_EQ(printed({.words = {path_of("env")}, .environment = {"ONE=1"}}).first, "ONE=1\n");
}

TEST(Program, HasNoInputAndNoOtherFiles) {
    const int open = ::dup(STDOUT_FILENO);  // without close-on-exec
    const std::string files = printed({.words = {path_of("ls"), "/proc/self/fd"}}).first;
    ::close(open);
    // Input, output, errors, and the folder opened by ls itself.
    EXPECT_EQ(files, "0\n1\n2\n3\n");
    EXPECT_EQ(printed({.words = {path_of("cat")}}).first, "");
}

TEST(Program, WorksInItsFolder) {
    const auto folder = std::filesystem::canonical(std::filesystem::temp_directory_path());
    EXPECT_EQ(printed({.words = {path_of("pwd")}, .folder = folder}).first, folder.string() + "\n");
}

TEST(Program, TellsHowItEnded) {
    EXPECT_EQ(WEXITSTATUS(printed({.words = {path_of("false")}}).second), 1);
    const pid_t program = start_program({.words = {path_of("sleep"), "60"}, .apart = true});
    EXPECT_FALSE(ended_program(program));
    EXPECT_EQ(::getsid(program), program);
    ::kill(program, SIGKILL);
    EXPECT_EQ(WTERMSIG(wait_for_program(program)), SIGKILL);
}

TEST(Program, ThatIsNotThereIsAnError) {
    EXPECT_THROW(start_program({.words = {"/no/such/program"}}), IoError);
}

}  // namespace
}  // namespace coppice
