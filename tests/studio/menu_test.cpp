#include "coppice/studio/menu/menu_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "coppice/scene/command.h"
#include "coppice/scene/scene.h"

namespace coppice {
namespace {

const MenuItem* item(const Menu& menu, std::string_view label) {
    const auto found = std::ranges::find(menu.items(), label, &MenuItem::label);
    return found == menu.items().end() ? nullptr : &*found;
}

TEST(StudioMenu, BuiltInItemsAreValidAndStartNoPrograms) {
    Menu menu;
    EXPECT_EQ(menu.add("clear\n" + std::string(built_in_menu()), "again"), std::vector<std::string>{});
    ASSERT_GT(menu.items().size(), 80u);
    for (const MenuItem& i : menu.items()) EXPECT_NE(i.does, MenuAction::program);
    EXPECT_EQ(item(menu, "Undo")->text, "undo");
}

TEST(StudioMenu, AddsReplacesAndRemovesItems) {
    Menu menu;
    const std::size_t count = menu.items().size();
    EXPECT_TRUE(menu.add("# mine\n[Crown]\nBall of 2 m = line sphere ball radius=3\nNew = tool place\n---\n"
                         "Column = nothing\n  [ My own ]  \n Help = page shortcuts \n",
                         "mine")
                    .empty());
    EXPECT_EQ(menu.items().size(), count + 2);  // New, a separator and Help, without Column
    EXPECT_EQ(item(menu, "Ball of 2 m")->text, "sphere ball radius=3");
    EXPECT_EQ(item(menu, "Column"), nullptr);
    EXPECT_EQ(item(menu, "New")->menu, "Crown");
    EXPECT_EQ(item(menu, "Help")->menu, "My own");
    EXPECT_TRUE(menu.add("clear\n[A]\nB = tool move\n", "mine").empty());
    EXPECT_EQ(menu.items().size(), 1u);
}

TEST(StudioMenu, SplitsTheWordsOfProgramsWithoutAShell) {
    Menu menu;
    EXPECT_TRUE(
        menu.add(
                "[P]\nB = program blender --python-expr \"a 'b' \\\"c\\\"\" 'x \"y' ${file.obj} $HOME \"\"\n",
                "mine")
            .empty());
    EXPECT_EQ(item(menu, "B")->words, (std::vector<std::string>{"blender", "--python-expr", "a 'b' \"c\"",
                                                                "x \"y", "${file.obj}", "$HOME", ""}));
}

TEST(StudioMenu, ReportsFaultsAndAcceptsTheRest) {
    const std::pair<const char*, const char*> wrong[] = {
        {"Ball = tool place", "mine:1: an item must belong to a menu"},
        {"[Crown", "mine:1: a menu starts with its name in brackets"},
        {"[]", "mine:1: a menu starts"},
        {"[C]\n\n# comment\nBall", "mine:4: an item has the form LABEL = ACTION"},
        {"[C]\n = tool place", "mine:2: an item has the form LABEL"},
        {"[C]\nB = fly", "mine:2: 'fly' is not an action"},
        {"[C]\nB = separator", "mine:2: 'separator' is not an action"},
        {"[C]\nB = tool ../x", "mine:2: '../x' is not the name of a tool"},
        {"[C]\nB = page", "mine:2: '' is not the name"},
        {"[C]\nB = line spher x", "sphere"},
        {"[C]\nB = set mesh.level 3", "mesh has no option 'level'"},
        {"[C]\nB = set mesh.levels many", "mine:2: levels takes"},
        {"[C]\nB = set mesh.levels", "needs a value"},
        {"[C]\nB = set levels 3", "COMMAND.ARGUMENT VALUE"},
        {"[C]\nB = program", "requires the name of a program"},
        {"[C]\nB = program ./x", "its absolute path"},
        {"[C]\nB = program ${file}", "is not a program"},
        {"[C]\nB = program a 'b", "is not closed"},
        {"[C]\nB = program a ${home}", "'${home}' is not a placeholder"},
        {"[C]\nB = program a ${file", "is not a placeholder"},
        {"[C]\nB = program a ${file.../x}", "is not a placeholder"},
        {"[C]\nNone = nothing", "there is no item 'None'"},
        {"[C]\nclear", "an item has the form LABEL"},
    };
    for (const auto& [text, message] : wrong) {
        Menu menu;
        const std::size_t count = menu.items().size();
        const auto faults = menu.add(std::string(text) + "\n[Z]\nGood = tool place\n", "mine");
        ASSERT_EQ(faults.size(), 1u) << text;
        EXPECT_NE(faults[0].find(message), std::string::npos) << text << " -> " << faults[0];
        EXPECT_EQ(menu.items().size(), count + 1) << text;
    }
}

TEST(StudioMenu, BuiltInLinesRun) {
    // As the page fills them in: free names, the selected objects, and the proposed answers.
    Scene scene({.files = true, .outputs = false});
    scene.run("sphere crown radius=2 center=0,0,4");
    scene.run("pointset generate crown count=200");
    scene.run("polygonize crown crown cell=0.5");
    scene.run("limb stem 0,0,0 0,0,1 0,0,3");
    scene.run("edit draw stem 0,0,2 1,0,2.5 2,0,3 radius=0.02");
    const std::regex made(R"(\$\{new (\w+)\})"), question(R"(\$\{ask [^,}]+,\s*([^}]*)\})"),
        object(R"(\$\{object\})");
    const Menu menu;
    for (const MenuItem& i : menu.items()) {
        if (i.does != MenuAction::line || i.text.find("library") != std::string::npos) continue;
        std::string line = std::regex_replace(std::regex_replace(i.text, made, "made_$1"), question, "$1");
        const bool of_tree = i.menu == "Branches" || i.menu == "Surface" || i.menu == "Compose" ||
                             line.starts_with("radii") || line.starts_with("tidy") ||
                             line.starts_with("grow made_tree crown ");
        line = std::regex_replace(line, object,
                                  of_tree && !line.starts_with("grow made_tree ${") ? "stem" : "crown");
        Scene copy = scene;
        EXPECT_NO_THROW(copy.run(line)) << i.label << ": " << line;
    }
}

}  // namespace
}  // namespace coppice
