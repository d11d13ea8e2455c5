#include "coppice/studio/menu/programs_internal.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <stop_token>
#include <thread>

#include "coppice/base/error.h"
#include "coppice/system/file.h"
#include "studio/session_fixture.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
using studio_internal::ProgramResult;
using studio_internal::Programs;

class StudioPrograms : public test::FolderTest {
  protected:
    ProgramResult run(std::vector<std::string> words, std::chrono::milliseconds patience = 60s,
                      const Context& ctx = {}) {
        return programs_.run(std::move(words), folder_, patience, ctx);
    }
    Programs programs_;
};

TEST_F(StudioPrograms, ReturnTheirOutputAndExitCode) {
    const ProgramResult result = run({"echo", "a  b", "$HOME;ls"});
    EXPECT_EQ(result.text, "a  b $HOME;ls\n");
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(run({"pwd"}).text, std::filesystem::canonical(folder_).string() + "\n");
    EXPECT_EQ(run({"cat"}).text, "");  // there is no input
    EXPECT_EQ(run({"false"}).status, 1);
    EXPECT_NE(run({"ls", "no-such-file"}).text.find("no-such-file"), std::string::npos);
}

TEST_F(StudioPrograms, HaveNoSecretsInTheirEnvironment) {
    ::setenv("COPPICE_TEST_TOKEN", "secret", 1);
    const std::string text = run({"env"}).text;
    ::unsetenv("COPPICE_TEST_TOKEN");
    EXPECT_EQ(text.find("secret"), std::string::npos);
    EXPECT_NE(text.find("PATH="), std::string::npos);
}

TEST_F(StudioPrograms, OutputIsTruncated) {
    const ProgramResult result = run({"head", "-c", "1000000", "/dev/zero"});
    EXPECT_EQ(result.text.size(), std::size_t{64} << 10);
    EXPECT_EQ(result.status, 0);
}

TEST_F(StudioPrograms, ContinueInTheBackground) {
    // It prints more than a pipe can buffer after the wait has ended, and ends normally.
    const ProgramResult result =
        run({"sh", "-c", "echo begun; sleep 0.3; head -c 200000 /dev/zero; touch done"}, 100ms);
    EXPECT_EQ(result.text, "begun\n");
    EXPECT_FALSE(result.status);
    EXPECT_EQ(programs_.going_on(), 1u);
    for (int i = 0; i < 600 && programs_.going_on() > 0; ++i) std::this_thread::sleep_for(50ms);
    EXPECT_EQ(programs_.going_on(), 0u);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "done"));
}

TEST_F(StudioPrograms, OutliveTheStudio) {
    {
        Programs programs;
        const auto result =
            programs.run({"sh", "-c", "sleep 0.4; echo ${PATH}; echo x; touch done"}, folder_, 50ms, {});
        EXPECT_FALSE(result.status);
    }
    for (int i = 0; i < 600 && !std::filesystem::exists(folder_ / "done"); ++i)
        std::this_thread::sleep_for(50ms);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "done"));
}

TEST_F(StudioPrograms, EndWhenCancelled) {
    std::stop_source stop;
    std::jthread later([&] {
        std::this_thread::sleep_for(100ms);
        stop.request_stop();
    });
    const auto start = std::chrono::steady_clock::now();
    EXPECT_THROW(run({"sh", "-c", "sleep 60; touch done"}, 60s,
                     {.threads = 0, .stop = stop.get_token(), .progress = {}}),
                 Cancelled);
    EXPECT_LT(std::chrono::steady_clock::now() - start, 30s);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "done"));
}

TEST_F(StudioPrograms, RejectMissingProgramsAndTooManyAtOnce) {
    EXPECT_THROW(run({"no-such-program-anywhere"}), InvalidInput);
    for (int i = 0; i < 8; ++i) EXPECT_FALSE(run({"sleep", "3"}, 1ms).status);
    EXPECT_THROW(run({"echo"}), InvalidInput);
}

class StudioMenuRequests : public test::SessionTest {
  protected:
    void SetUp() override {
        SessionTest::SetUp();
        options_.menus = {folder_ / "mine.menu", folder_ / "missing.menu"};
        write_file(options_.menus[0],
                   "clear\n[P]\nList = program cat ${file}\nFolder = program echo ${folder}\n"
                   "Tree = program cat ${file.swc}\nName = program echo ${object}\nBad = fly\n");
        reopen();
    }
    Json start(int number, const Json& more = Json::object()) {
        Json request{{"type", "program"}, {"item", number}};
        request.update(more);
        return ask(request);
    }
};

TEST_F(StudioMenuRequests, ReturnTheItemsAndTheirFaults) {
    const Json menu = must({{"type", "menu"}});
    ASSERT_EQ(menu["items"].size(), 4u);
    EXPECT_EQ(
        menu["items"][0],
        Json(
            {{"number", 0}, {"menu", "P"}, {"label", "List"}, {"does", "program"}, {"text", "cat ${file}"}}));
    ASSERT_EQ(menu["faults"].size(), 1u);
    EXPECT_NE(menu["faults"][0].get<std::string>().find("mine.menu:7: "), std::string::npos);
    EXPECT_EQ(menu["files"].size(), 2u);
}

TEST_F(StudioMenuRequests, StartTheProgramsOfTheUserMenu) {
    EXPECT_NE(refused({{"type", "program"}, {"item", 0}}).find("request the menu again"), std::string::npos);
    must({{"type", "menu"}});
    run("limb t 0,0,0 0,0,1 0,0,2");
    EXPECT_EQ(start(0)["text"], "limb t 0,0,0 0,0,1 0,0,2\n");  // a copy of the unsaved text
    EXPECT_EQ(start(1)["text"], std::filesystem::canonical(folder_).string() + "\n");
    const Json object{{"kind", "skeleton"}, {"name", "t"}};
    EXPECT_NE(start(2, object)["text"].get<std::string>().find("\n1 "), std::string::npos);
    EXPECT_EQ(start(3, object)["text"], "t\n");
    EXPECT_EQ(start(3)["kind"], "input");
    EXPECT_EQ(start(4)["kind"], "input");
    EXPECT_EQ(start(2)["kind"], "input");
}

TEST_F(StudioMenuRequests, NeverReadTheMenuOfTheFolder) {
    write_file(folder_ / "studio.menu", "clear\n[P]\nEvil = program touch evil\n");
    options_.menus.clear();
    reopen();
    for (const Json all = must({{"type", "menu"}}); const Json& item : all["items"])
        EXPECT_NE(item["does"], "program");
}

}  // namespace
}  // namespace coppice
