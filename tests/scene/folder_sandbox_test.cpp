#include "coppice/system/folder_sandbox.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>

#include "coppice/scene/save.h"
#include "coppice/scene/scene.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

class SceneFolderSandboxTest : public test::FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        folder_ = fs::canonical(folder_);
        home_ = folder_ / "home";
        fs::create_directories(home_ / "sub");
        std::ofstream(folder_ / "secret.xyz") << "0 0 0\n1 0 0\n";
        std::ofstream(home_ / "cloud.xyz") << "0 0 0\n1 0 0\n";
        fs::create_symlink(folder_ / "secret.xyz", home_ / "link.xyz");
    }
    SceneSettings settings(std::vector<fs::path> allowed = {}) const {
        return {.max_memory = 512,
                .sandbox = std::make_shared<const FolderSandbox>(home_, std::move(allowed))};
    }

    fs::path home_;
};

bool is_file(const Argument& a) {
    return a.type == ArgumentType::input_file || a.type == ArgumentType::output_file ||
           a.type == ArgumentType::properties;
}

/// Returns the last line of the example with its file replaced by another, or with the file added as an
/// option.
std::string line_with(const SceneCommand& command, const Argument& argument, const std::string& outside) {
    const std::size_t begin = command.example.rfind('\n') + 1;
    std::string line = command.example.substr(begin);
    const std::regex name("[a-z0-9_]+(\\.[a-z]+)+");
    if (argument.positional && std::regex_search(line, name))
        return std::regex_replace(line, name, "\"" + outside + "\"");
    return line + " " + argument.name + "=\"" + outside + "\"";
}

TEST_F(SceneFolderSandboxTest, NoCommandAccessesAFileOutside) {
    Scene scene(settings());
    int tried = 0;
    for (const SceneCommand& c : scene_commands()) {
        SCOPED_TRACE(c.name);
        const bool needs_file =
            std::ranges::any_of(c.arguments, [](auto& a) { return is_file(a) && a.required; });
        if (const auto end = c.example.rfind('\n'); needs_file && end != std::string::npos)
            scene.run_text(c.example.substr(0, end), "example");
        for (const Argument& a : c.arguments) {
            if (!is_file(a)) continue;
            for (const fs::path& name :
                 {folder_ / "secret.xyz", fs::path("../secret.xyz"), fs::path("link.xyz"),
                  fs::path("sub/../../secret.xyz"), fs::path(".ssh/key.xyz")}) {
                const std::string line = line_with(c, a, name.string());
                const std::string error = test::error_of<IoError>([&] { scene.run(line); });
                EXPECT_NE(error.find("cannot "), std::string::npos) << line << " says " << error;
                ++tried;
            }
        }
        if (!needs_file) scene.run_text(c.example, c.name);
    }
    EXPECT_GE(tried, 50);
    std::size_t outside = 0;
    for (const auto& entry : fs::directory_iterator(folder_)) outside += entry.path() == home_ ? 0 : 1;
    EXPECT_EQ(outside, 1u);
    EXPECT_EQ(fs::file_size(folder_ / "secret.xyz"), 12u);
}

TEST_F(SceneFolderSandboxTest, FilesInsideAreReadAndWritten) {
    Scene scene(settings());
    scene.run("pointset load p cloud.xyz");
    scene.run("save p sub/out.xyz");
    EXPECT_TRUE(fs::exists(home_ / "sub" / "out.xyz"));
    EXPECT_EQ(scene.state().history.size(), 1u);
    // So that the recipe can run in the same sandbox.
    EXPECT_EQ(scene.state().history.front().find(folder_.string()), std::string::npos);
    Scene again(settings());
    again.run_text(make_recipe(scene.state()), "recipe");
    EXPECT_EQ(again.state().objects.size(), 1u);
}

TEST_F(SceneFolderSandboxTest, AllowedFileIsRead) {
    Scene scene(settings({folder_ / "secret.xyz"}));
    scene.run("pointset load p \"" + (folder_ / "secret.xyz").string() + "\"");
    EXPECT_NE(test::error_of<IoError>([&] { scene.run("save p ../secret.xyz"); }), "no error");
}

TEST_F(SceneFolderSandboxTest, IsIndependentOfTheCurrentFolder) {
    const fs::path before = fs::current_path();
    fs::current_path(folder_);
    Scene scene(settings());
    EXPECT_NE(test::error_of<IoError>([&] { scene.run("pointset load p secret.xyz"); }), "no error");
    fs::current_path(before);
}

}  // namespace
}  // namespace coppice
