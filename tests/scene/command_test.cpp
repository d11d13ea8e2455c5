#include "coppice/scene/command.h"

#include <gtest/gtest.h>

#include <set>

#include "coppice/scene/scene.h"
#include "errors.h"

namespace coppice {
namespace {

bool is_file(const Argument& a) {
    return a.type == ArgumentType::input_file || a.type == ArgumentType::output_file ||
           a.type == ArgumentType::properties;
}

bool uses_files(const SceneCommand& c) {
    return std::ranges::any_of(c.arguments, [](const Argument& a) { return is_file(a) && a.required; });
}

TEST(SceneCommands, TableIsValid) {
    std::set<std::string> names;
    for (const SceneCommand& c : scene_commands()) {
        SCOPED_TRACE(c.name);
        EXPECT_TRUE(names.insert(c.name).second);
        for (const std::string& alias : c.aliases) EXPECT_TRUE(names.insert(alias).second) << alias;
        EXPECT_TRUE(c.help.ends_with('.')) << c.help;
        EXPECT_FALSE(c.group.empty());
        EXPECT_TRUE(c.run);
        EXPECT_NE(c.example.find(c.name), std::string::npos);
        std::set<std::string> arguments;
        int repeated = 0;
        for (const Argument& a : c.arguments) {
            SCOPED_TRACE(a.name);
            EXPECT_TRUE(arguments.insert(a.name).second);
            EXPECT_TRUE(a.help.ends_with('.')) << a.help;
            EXPECT_LE(a.low, a.high);
            if (a.positional && a.repeats) ++repeated;
            if (a.required) {
                EXPECT_TRUE(a.positional);
            }
            if (!a.initial.empty() && a.initial[0] != '@') {
                EXPECT_NO_THROW(parse_argument(a, a.initial));
            }
        }
        EXPECT_LE(repeated, 1);
    }
    EXPECT_GE(names.size(), 45u);
}

TEST(SceneCommands, ExamplesRunAndCreateTheStatedObjects) {
    Scene scene({.max_memory = 512});
    for (const SceneCommand& c : scene_commands()) {
        if (uses_files(c)) continue;
        SCOPED_TRACE(c.name);
        const std::size_t before = scene.state().made.size();
        EXPECT_NO_THROW(scene.run_text(c.example, c.name));
        if (!c.makes) continue;
        ASSERT_GT(scene.state().made.size(), before);
        EXPECT_EQ(scene.state().made.back().first, *c.makes);
    }
    EXPECT_GE(scene.state().objects.size(), 30u);
}

std::string refusal(Scene& scene, const std::string& line) {
    return test::error_of<Error>([&] { scene.run(line); });
}

TEST(SceneCommands, ErrorsReportTheWordAndTheNearestSpelling) {
    Scene scene;
    scene.run_text("sphere crown\nprofile p circle=1\npolygonize crown mesh", "x");
    EXPECT_EQ(refusal(scene, "shpere s"), "there is no command 'shpere'; did you mean sphere?");
    EXPECT_EQ(refusal(scene, "pointset thni a b 1"),
              "there is no command 'pointset thni'; did you mean pointset thin?");
    EXPECT_EQ(refusal(scene, "xyzzy"), "there is no command 'xyzzy'; help lists them");
    EXPECT_EQ(refusal(scene, "sphere s raduis=2"), "sphere has no option 'raduis'; did you mean radius?");
    EXPECT_EQ(refusal(scene, "grow t p influence=3"),
              "grow has no option 'influence'; did you mean influence_radius?");
    EXPECT_EQ(refusal(scene, "sphere s radius=1 radius=2"), "radius is given twice");
    EXPECT_EQ(refusal(scene, "sphere s 1 2"), "sphere does not accept '1'");
    EXPECT_EQ(refusal(scene, "scale crwon 2"), "there is no solid 'crwon'; did you mean crown?");
    EXPECT_EQ(refusal(scene, "scale p 2"), "'p' is a profile, not a solid");
    EXPECT_EQ(refusal(scene, "scale mesh 2"),
              "'mesh' is a mesh, not a solid; create one from it with: solid mesh");
    EXPECT_EQ(refusal(scene, "pointset near crown"),
              "'crown' is a solid, not a mesh; create one from it with: polygonize crown");
    EXPECT_EQ(refusal(scene, "scale crown 2 3"),
              "factors takes 1 or 3 numbers from -1e+06 to 1e+06 joined by commas, not '2,3'");
    EXPECT_EQ(
        refusal(scene, "rotate crown"),
        "rotate needs angle: a number of degrees from -3.6e+05 to 3.6e+05, as in: rotate s 30 axis=1,0,0");
    EXPECT_EQ(refusal(scene, "pointset thin"),
              "pointset thin needs points: the name of points, as in: pointset thin s secondary 80");
    EXPECT_EQ(refusal(scene, "describe crwon"), "there is no object 'crwon'; did you mean crown?");
    EXPECT_EQ(refusal(scene, "sphere 2s"),
              "name takes a name (letters, digits, _, - and . after a letter, at most 64), not '2s'");
    EXPECT_EQ(refusal(scene, "union crown u"),
              "union: name at least two solids and then the result, as in: union s l both");
    EXPECT_EQ(refusal(scene, "sphere s radius=0"),
              "radius takes a number of metres from 1e-05 to 100000, not '0'");
}

TEST(SceneCommands, PointsAcceptBlanksOrCommas) {
    Scene scene;
    scene.run_text("sphere a\nsphere b\ntranslate a 1 2 3\ntranslate b 1,2,3", "x");
    const auto bounds = [&](const std::string& name) {
        return std::get<Solid>(scene.state().objects.at({ObjectKind::solid, name})->value).bounds();
    };
    EXPECT_EQ(bounds("a").low, bounds("b").low);
    EXPECT_EQ(bounds("a").high, bounds("b").high);
}

// Zero, negative, huge and invalid numbers, for every number of every command, lead to a message or a result,
// without long work because memory is limited.
TEST(SceneCommands, UnusualNumbersAreAcceptedOrRejectedWithAMessage) {
    int option_count = 0;
    for (const SceneCommand& c : scene_commands()) {
        if (uses_files(c)) continue;
        Scene scene({.max_memory = 8});
        for (const SceneCommand& before : scene_commands()) {
            if (&before == &c) break;
            if (!uses_files(before)) refusal(scene, before.example);
        }
        const std::string line = c.example.substr(c.example.rfind('\n') + 1);
        for (const Argument& a : c.arguments) {
            if (a.type != ArgumentType::number && a.type != ArgumentType::whole) continue;
            if (a.positional || line.find(a.name + "=") != std::string::npos) continue;
            for (const std::string value : {"nan", "1e400", "-1"}) {
                const std::string message = refusal(scene, line + " " + a.name + "=" + value);
                ++option_count;
                if (value != "-1") {
                    EXPECT_NE(message, "no error") << c.name << " " << a.name;
                }
                EXPECT_EQ(message.find('\n'), std::string::npos);
            }
        }
    }
    EXPECT_GT(option_count, 200);
}

}  // namespace
}  // namespace coppice
