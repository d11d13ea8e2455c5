#include "coppice/system/program.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <utility>

#include "coppice/base/error.h"

namespace coppice {
namespace {

/// Output of a program and its exit code.
std::pair<std::string, int> printed(ProgramStart start) {
    start.output = ProgramOutput::received;
    Program program(start);
    std::string out;
    while (program.receive(out, 1 << 16, std::chrono::seconds(10))) {
    }
    return {out, program.wait()};
}

std::string find_path(std::string_view name) { return find_program(name).value().string(); }

TEST(Program, IsFoundByNameInAbsoluteFoldersOnly) {
    EXPECT_TRUE(find_program("sh"));
    EXPECT_TRUE(find_program("sh")->is_absolute());
    EXPECT_FALSE(find_program("no-such-program-anywhere"));
    EXPECT_FALSE(find_program("./sh"));
    EXPECT_FALSE(find_program(""));
    EXPECT_FALSE(find_program("/"));
}

TEST(Program, ReceivesItsWordsUnchanged) {
    const auto [text, status] = printed({.words = {find_path("echo"), "a b", "$HOME", "*"}});
    EXPECT_EQ(text, "a b $HOME *\n");
    EXPECT_EQ(status, 0);
}

TEST(Program, HasTheGivenEnvironment) {
    EXPECT_EQ(printed({.words = {find_path("env")}, .environment = {"ONE=1"}}).first, "ONE=1\n");
}

TEST(Program, HasNoInputAndNoOtherFiles) {
    const int open = ::dup(STDOUT_FILENO);  // without close-on-exec
    const std::string files = printed({.words = {find_path("ls"), "/proc/self/fd"}}).first;
    ::close(open);
    // Input, output, errors, and the folder opened by ls itself.
    EXPECT_EQ(files, "0\n1\n2\n3\n");
    EXPECT_EQ(printed({.words = {find_path("cat")}}).first, "");
}

TEST(Program, RunsInItsFolder) {
    const auto folder = std::filesystem::canonical(std::filesystem::temp_directory_path());
    EXPECT_EQ(printed({.words = {find_path("pwd")}, .folder = folder}).first, folder.string() + "\n");
}

TEST(Program, ReturnsItsExitCodeOrSignal) {
    EXPECT_EQ(printed({.words = {find_path("false")}}).second, 1);
    Program program({.words = {find_path("sleep"), "60"}, .apart = true});
    EXPECT_FALSE(program.status());
    program.kill();
    EXPECT_EQ(program.wait(), 128 + SIGKILL);
    EXPECT_EQ(program.status(), 128 + SIGKILL);
}

TEST(Program, RunsInItsOwnSessionIfRequested) {
    const auto find_session = [](bool apart) {
        return printed({.words = {find_path("cut"), "-d ", "-f6", "/proc/self/stat"}, .apart = apart}).first;
    };
    EXPECT_EQ(find_session(false), fmt::format("{}\n", ::getsid(0)));
    EXPECT_NE(find_session(true), find_session(false));
}

TEST(Program, ReceivesTheSentInput) {
    Program program({.words = {find_path("cat")}, .sends_input = true, .output = ProgramOutput::received});
    EXPECT_TRUE(program.send("one "));
    EXPECT_TRUE(program.send("two"));
    program.close_input();
    std::string text;
    while (program.receive(text, 5, std::chrono::seconds(10))) {
    }
    EXPECT_EQ(text, "one t");  // the rest is dropped
    EXPECT_EQ(program.wait(), 0);
}

TEST(Program, SendToAnEndedProgramFailsWithoutASignal) {
    Program program({.words = {find_path("true")}, .sends_input = true});
    program.wait();
    EXPECT_FALSE(program.send(std::string(1 << 20, 'x')));
}

TEST(Program, ThrowsIfItDoesNotExist) { EXPECT_THROW(Program({.words = {"/no/such/program"}}), IoError); }

}  // namespace
}  // namespace coppice
