#include "coppice/scene/script/script.h"

#include <gtest/gtest.h>

#include <chrono>

#include "coppice/scene/save.h"
#include "coppice/scene/scene.h"
#include "errors.h"

namespace coppice {
namespace {

/// Returns the commands to which the lines expand.
std::vector<std::string> commands_of_text(const std::string& text,
                                          std::map<std::string, std::string> given = {}) {
    SceneScript script(std::move(given), 1000);
    std::vector<std::string> out;
    const auto run = [&](std::string_view command, const std::string&) { out.emplace_back(command); };
    for (const SceneLine& line : scene_lines(text, "x"))
        script.take(line.text, "x:" + std::to_string(line.number), run, {});
    script.finish();
    return out;
}

std::string refusal(const std::string& text, std::map<std::string, std::string> given = {}) {
    return test::error_of<Error>([&] { commands_of_text(text, std::move(given)); });
}

using Lines = std::vector<std::string>;

TEST(SceneScript, LinesWithoutVariablesAreUnchanged) {
    const std::string line = "  sphere \"a b\"\tx=\"1 2\" $5 {a} # $comment";
    EXPECT_EQ(commands_of_text(line), Lines{line});
    EXPECT_EQ(commands_of_text("list # ${of what}"), Lines{"list"});
}

TEST(SceneScript, ExpandsVariablesInWords) {
    EXPECT_EQ(
        commands_of_text(
            "let n = 3  # three\nlet name=\"my tree\"\nsave ${name} x=${n + 1} a${n}b ${n},${ n * 2 },0"),
        (Lines{"save \"my tree\" x=4 a3b 3,6,0"}));
    // An expanded variable is one word for any value.
    EXPECT_EQ(commands_of_text("let a = \"x=1 # \\\"\"\nsave ${a} y=${a}"),
              (Lines{"save \"x=1 # \\\"\" y=\"x=1 # \\\"\""}));
}

TEST(SceneScript, LoopsCountUpAndDown) {
    EXPECT_EQ(commands_of_text("for i in 1..3\nlist ${i}\nend"), (Lines{"list 1", "list 2", "list 3"}));
    EXPECT_EQ(commands_of_text("for i in 5..1 step -2\nlist ${i}\nend"),
              (Lines{"list 5", "list 3", "list 1"}));
    EXPECT_EQ(commands_of_text("for i in 3..1\nlist\nend"), Lines{});
    EXPECT_EQ(commands_of_text("for t in 0..1 step 0.1\nlist\nend").size(), 11u);
    EXPECT_EQ(commands_of_text("let n = 2\nfor i in n-1..n*2 step n/2\nlist ${i}\nend"),
              (Lines{"list 1", "list 2", "list 3", "list 4"}));
    EXPECT_EQ(commands_of_text("repeat 2\nlist\nend\nrepeat 0\nlist no\nend"), (Lines{"list", "list"}));
}

TEST(SceneScript, BlocksMayBeNested) {
    EXPECT_EQ(commands_of_text(
                  "for i in 1..2\nfor j in 1..i\nif i == j\nlist ${i}${j}\nelse\nlist other\nend\nend\nend"),
              (Lines{"list 11", "list other", "list 22"}));
    EXPECT_EQ(commands_of_text("if 0\nlist a\nend\nif 1\nlist b\nelse\nlist c\nend"), Lines{"list b"});
}

TEST(SceneScript, LetInALoopAccumulates) {
    EXPECT_EQ(commands_of_text("let z = 0\nrepeat 3\nlet z = z + 0.5\nlist ${z}\nend"),
              (Lines{"list 0.5", "list 1", "list 1.5"}));
}

TEST(SceneScript, LoopVariableEndsWithTheLoop) {
    EXPECT_EQ(refusal("for i in 1..2\nlist\nend\nlist ${i}"), "x:4: there is no variable 'i'");
    EXPECT_EQ(commands_of_text("let i = 7\nfor i in 1..2\nend\nlist ${i}"), Lines{"list 7"});
}

TEST(SceneScript, GivenValuesReplaceTheFirstLet) {
    EXPECT_EQ(commands_of_text("let n = 2\nlet n = n * 10\nlist ${n}", {{"n", "5"}}), Lines{"list 50"});
    EXPECT_EQ(commands_of_text("let kind = \"oak\"\nlist ${kind}", {{"kind", "12"}}), Lines{"list 12"});
    EXPECT_EQ(refusal("let n = 2", {{"n", "many"}}), "x:1: let: n is a number, and is set to 'many'");
}

TEST(SceneScript, ErrorsReportTheLine) {
    EXPECT_EQ(refusal("let n = 1\n\nlist ${zzz + 1}"), "x:3: there is no variable 'zzz'");
    EXPECT_EQ(refusal("let 2n = 1").substr(0, 37), "x:1: let: '2n' is not a valid name of");
    EXPECT_EQ(refusal("let n"), "x:1: let: the syntax of this line is: let NAME = EXPRESSION");
    EXPECT_EQ(refusal("let n ="), "x:1: let: the syntax of this line is: let NAME = EXPRESSION");
    EXPECT_EQ(refusal("for i 1..2\nend"),
              "x:1: for: the syntax of this line is: for NAME in FIRST..LAST [step STEP]");
    EXPECT_EQ(refusal("for i in 1 2\nend"),
              "x:1: for: the syntax of this line is: for NAME in FIRST..LAST [step STEP]");
    EXPECT_EQ(refusal("for i in 1..2 step 0\nend"),
              "x:1: for: the step is 0, and would never reach the last number");
    EXPECT_EQ(refusal("repeat 1.5\nend"), "x:1: repeat: it needs a whole number of turns, not 1.5");
    EXPECT_EQ(refusal("list\nend"), "x:2: end: there is no open block to which it could belong");
    EXPECT_EQ(refusal("for i in 1..2\nelse\nend"), "x:2: else: there is no open if to which it could belong");
    EXPECT_EQ(refusal("if 1\nelse\nelse\nend"), "x:3: else: there is no open if to which it could belong");
    EXPECT_EQ(refusal("if 1\nelse if 2\nend"), "x:2: else: the syntax of this line is: else");
    EXPECT_EQ(refusal("list\nrepeat 2\nlist"), "x:2: no end closes this repeat");
    EXPECT_EQ(refusal("repeat 2\nlist\nlet n = n\nend"), "x:3: let: there is no variable 'n'");
}

TEST(SceneScript, RejectsExcessiveBlocks) {
    const std::string many =
        "x:3: the block has run 1000 lines, which is the maximum; make its loops shorter";
    EXPECT_EQ(refusal("repeat 1e300\nlist\nend"), many);
    EXPECT_NE(refusal("repeat 1e9\nend").find("has run 1000 lines"), std::string::npos);
    EXPECT_NE(refusal("for i in 0..1e308 step 1e-300\nfor j in 0..1\nend\nend").find("has run 1000 lines"),
              std::string::npos);
    std::string deep;
    for (int i = 0; i < 40; ++i) deep += "repeat 10\n";
    EXPECT_EQ(refusal(deep), "x:33: repeat: blocks may be nested at most 32 deep");
    // Texts that double in length.
    std::string doubled = "let a = \"aaaaaaaaaaaaaaaa\"\n";
    for (int i = 0; i < 40; ++i) doubled += "let a = \"${a}${a}\"\n";
    EXPECT_EQ(refusal(doubled), "x:10: let: a text may have at most 4096 bytes");
    std::string wide = "let a = \"" + std::string(4000, 'a') + "\"\nlist";
    for (int i = 0; i < 300; ++i) wide += " ${a}";
    EXPECT_EQ(refusal(wide), "x:2: with its variables the line is longer than 1048576 bytes");
    // A long line with many unclosed expressions.
    std::string open = "list";
    for (int i = 0; i < 150'000; ++i) open += " ${";
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(refusal(open), "x:1: a ${ is not closed by }");
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
}

TEST(SceneScript, LoopsStopWhenCancelled) {
    SceneScript script;
    std::stop_source stop;
    int ran = 0;
    const auto run = [&](std::string_view, const std::string&) {
        if (++ran == 10) stop.request_stop();
    };
    const Context ctx{.stop = stop.get_token()};
    script.take("repeat 1000", "", run, ctx);
    script.take("list", "", run, ctx);
    EXPECT_TRUE(script.open());
    EXPECT_THROW(script.take("end", "", run, ctx), Cancelled);
    EXPECT_EQ(ran, 10);
    EXPECT_FALSE(script.open());
}

TEST(SceneScript, RejectedLinePreservesTheOpenBlock) {
    Scene scene;
    scene.run("repeat 2");
    EXPECT_THROW(scene.run("let 3 = x"), InvalidInput);
    EXPECT_TRUE(scene.waits());
    scene.run("sphere s");
    EXPECT_TRUE(scene.state().objects.empty());
    scene.run("end");
    EXPECT_FALSE(scene.waits());
    EXPECT_EQ(scene.state().objects.size(), 1u);
    scene.run("for i in 1..2");
    EXPECT_EQ(test::error_of([&] { scene.finish(); }), "no end closes this for");
    EXPECT_FALSE(scene.waits());
}

TEST(SceneSteps, BlockIsOneStepAndMustBeClosed) {
    const auto lines = scene_lines("list\nrepeat 2\nif 1\nlist\nend\nend\nlist", "x");
    const auto steps = scene_steps(lines, "x");
    ASSERT_EQ(steps.size(), 3u);
    EXPECT_EQ(steps[1].size(), 5u);
    EXPECT_EQ(test::error_of([] { scene_steps(scene_lines("list\nrepeat 2\nif 1\nend", "x"), "x"); }),
              "x:2: no end closes this repeat");
    // No command has run then.
    Scene scene;
    EXPECT_THROW(scene.run_text("sphere s\nrepeat 2", "x"), InvalidInput);
    EXPECT_TRUE(scene.state().objects.empty());
    EXPECT_EQ(
        find_variables(scene_lines("let a = 1\nfor i in 1..2\nlet b = a\nlet a = 2\nend\nlet 3 = 4", "x")),
        (Lines{"a", "b"}));
}

TEST(Scene, RecipesContainTheValuesOfVariables) {
    Scene scene({.variables = {{"r", "2"}}});
    scene.run_text("let r = 1\nfor i in 1..2\nsphere s${i} radius=${r * i}\nend", "x");
    const std::string recipe = make_recipe(scene.state());
    EXPECT_NE(recipe.find("sphere s1 center=0,0,0 radius=2 "), std::string::npos) << recipe;
    EXPECT_NE(recipe.find("sphere s2 center=0,0,0 radius=4 "), std::string::npos) << recipe;
    EXPECT_EQ(recipe.find("${"), std::string::npos);
    Scene again;
    again.run_text(recipe, "recipe");
    EXPECT_EQ(again.state().objects.size(), 2u);
}

TEST(Scene, SeedDeterminesRandomNumbersAndCommands) {
    const auto radius = [](int seed, const std::string& before) {
        Scene scene({.seed = seed});
        scene.run_text(before + "sphere s radius=${random(1, 2)}\npointset gen s count=10", "x");
        return scene.state().history.back() + scene.state().history.front();
    };
    EXPECT_EQ(radius(3, ""), radius(3, ""));
    EXPECT_NE(radius(3, ""), radius(4, ""));
    EXPECT_EQ(radius(3, ""), radius(0, "set seed 3\n"));
    EXPECT_EQ(radius(3, "set seed 7\n"), radius(4, "let a = random(0, 1)\nset seed 7\n"));
}

TEST(Scene, AFailingLineDrawsNoRandomNumber) {
    Scene scene;
    EXPECT_THROW(scene.run("sphere s radius=${random(1, 2)} x=1"), InvalidInput);
    EXPECT_EQ(scene.variables().draws, 0u);
    scene.run("sphere s radius=${random(1, 2)}");
    EXPECT_EQ(scene.variables().draws, 1u);
}

TEST(Scene, HistoryAndOutputOfLoopsAreLimited) {
    Scene scene({.max_memory = 2});
    std::string points;
    for (int i = 0; i < 2000; ++i) points += " " + std::to_string(i) + ",0,0";
    const std::string message =
        test::error_of([&] { scene.run_text("repeat 50000\npath p" + points + "\nend", "x"); });
    EXPECT_NE(message.find("MiB"), std::string::npos) << message;
    const std::string much = test::error_of([] {
        Scene().run_text("sphere abcdefghij\nrepeat 99999\nlist\ndescribe abcdefghij\nhelp\nend", "x");
    });
    // The line that exceeds the limit depends on the length of the help.
    EXPECT_TRUE(
        much.ends_with(": the output of the block exceeds 16 MiB; let fewer of its turns list or describe"))
        << much;
}

TEST(SceneStatements, ExamplesRun) {
    for (const SceneStatement& s : scene_statements()) {
        SCOPED_TRACE(s.name);
        Scene scene;
        EXPECT_NO_THROW(scene.run_text(s.example, "x"));
        EXPECT_FALSE(scene.state().objects.empty());
    }
}

}  // namespace
}  // namespace coppice
