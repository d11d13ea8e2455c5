#include "coppice/scene/reference.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "coppice/scene/scene.h"
#include "coppice/system/file.h"
#include "paths.h"

namespace coppice {
namespace {

using Words = std::vector<std::string>;

TEST(SceneReference, PageMatchesTheTable) {
    const std::string page = read_file(source_dir() / "docs/user/scene-reference.md");
    EXPECT_TRUE(page == scene_reference())
        << "regenerate it by: coppice run --reference > docs/user/scene-reference.md";
}

TEST(SceneReference, EveryArgumentIsExplained) {
    for (const SceneCommand& c : scene_commands()) {
        const std::string help = format_help(scene_words(c.name == "save" ? "save x" : c.name));
        for (const Argument& a : c.arguments)
            EXPECT_NE(help.find(a.help), std::string::npos) << c.name << " " << a.name;
        EXPECT_NE(help_overview().find(c.help), std::string::npos) << c.name;
    }
    EXPECT_EQ(scene_schema().size(), scene_commands().size());
}

TEST(SceneReference, HelpOfAFamilyListsIt) {
    const std::string help = format_help(scene_words("pointset"));
    EXPECT_NE(help.find("pointset thin"), std::string::npos);
    EXPECT_NE(help.find("pointset near"), std::string::npos);
    EXPECT_THROW(format_help(scene_words("shpere")), InvalidInput);
}

TEST(SceneReference, UsageShowsOptionalArguments) {
    std::size_t used = 0;
    EXPECT_EQ(format_usage(find_command(scene_words("diff"), used)), "diff PARTS... RESULT");
    EXPECT_EQ(format_usage(find_command(scene_words("mesh"), used)), "mesh TREE [NAME] [OPTION=VALUE...]");
}

TEST(SceneReference, CompletesCommandsOptionsValuesAndNames) {
    Scene scene;
    scene.run_text("sphere crown\nsphere cross\nprofile cr circle=1", "x");
    const SceneState& state = scene.state();
    EXPECT_EQ(completions("sph", state), (Words{"sphere"}));
    EXPECT_EQ(completions("pointset th", state), (Words{"thin"}));
    EXPECT_EQ(completions("scale cr", state), (Words{"cross", "crown"}));
    EXPECT_EQ(completions("revolve r ", state), (Words{"axis=", "cr", "influence=", "law=", "origin="}));
    EXPECT_EQ(completions("sphere s r", state), (Words{"radius="}));
    EXPECT_EQ(completions("pointset generate crown density=in", state),
              (Words{"density=inside_boundary", "density=inverse"}));
    EXPECT_EQ(completions("union cross cro", state), (Words{"cross", "crown"}));
    EXPECT_EQ(completions("nonsense x", state), Words{});
    EXPECT_EQ(completions("save \"a b", state), Words{});
    EXPECT_GT(completions("", state).size(), 30u);
    EXPECT_NE(std::ranges::count(completions("help pointset ", state), "thin"), 0);
}

}  // namespace
}  // namespace coppice
