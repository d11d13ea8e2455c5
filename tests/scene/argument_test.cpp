#include "coppice/scene/argument.h"

#include <gtest/gtest.h>

#include <numbers>

#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/points/sampling/generate.h"
#include "coppice/render/render.h"
#include "errors.h"

namespace coppice {
namespace {

Argument number(double low, double high, Unit unit = Unit::none) {
    Argument a{.name = "size", .type = ArgumentType::number};
    a.low = low;
    a.high = high;
    a.unit = unit;
    return a;
}

std::string refusal(const Argument& a, const std::string& text) {
    return test::error_of([&] { parse_argument(a, text); });
}

TEST(SceneArgument, NumbersMustBeFiniteAndInRange) {
    const Argument a = number(0, 10, Unit::metre);
    EXPECT_EQ(parse_argument(a, "+2.5").numbers, std::vector<double>{2.5});
    for (const char* text : {"nan", "inf", "-inf", "1e999", "x", "", "1x", "0x1", "-1", "10.1", "1,2"})
        EXPECT_NE(refusal(a, text), "no error") << text;
    EXPECT_EQ(refusal(a, "x"), "size takes a number of metres from 0 to 10, not 'x'");
    EXPECT_NE(refusal(number(0, 0), "1e39"), "no error");  // beyond the range of float
}

TEST(SceneArgument, RejectsFractionsOfWholeNumbers) {
    Argument a = number(0, 10);
    a.type = ArgumentType::whole;
    EXPECT_EQ(parse_argument(a, "7").numbers, std::vector<double>{7});
    EXPECT_EQ(refusal(a, "7.5"), "size takes a whole number from 0 to 10, not '7.5'");
}

TEST(SceneArgument, AnglesAreTypedInDegrees) {
    const Argument a = number(-3.1416, 3.1416, Unit::radian);
    EXPECT_DOUBLE_EQ(in_library_unit(a, parse_argument(a, "90").numbers[0]), std::numbers::pi / 2);
    EXPECT_DOUBLE_EQ(in_library_unit(a, parse_argument(a, "180").numbers[0]), std::numbers::pi);
    EXPECT_EQ(refusal(a, "181"), "size takes a number of degrees from -180 to 180, not '181'");
}

TEST(SceneArgument, ChoicesMayBeAbbreviatedIfUnique) {
    auto pattern = PointPattern::uniform;
    const Argument a = to_argument({Field{"pattern", "how"}, choice_of(pattern)});
    EXPECT_EQ(parse_argument(a, "poisson").text, "poisson_disk");
    EXPECT_EQ(a.initial, "uniform");
    EXPECT_EQ(
        refusal(a, "jitered"),
        "pattern takes one of poisson_disk, clustered, uniform, jittered, blue_noise, not 'jitered'; did you "
        "mean jittered?");
    Argument b = a;
    b.choices = {"inside", "inverse"};
    EXPECT_NE(refusal(b, "in"), "no error");
}

TEST(SceneArgument, ParsesTuplesAndSections) {
    Argument a{.name = "center", .type = ArgumentType::tuple};
    a.sizes = {3};
    EXPECT_EQ(parse_argument(a, "1,-2,3e1").numbers, (std::vector<double>{1, -2, 30}));
    for (const char* text : {"1,2", "1,2,3,4", "1,,3", "1,2,x", ",,", "1 2 3"})
        EXPECT_NE(refusal(a, text), "no error") << text;
    Argument s{.name = "sections", .type = ArgumentType::section};
    s.high = 1;
    const ArgumentValue value = parse_argument(s, "top@0.25");
    EXPECT_EQ(value.text, "top");
    EXPECT_EQ(value.numbers, std::vector<double>{0.25});
    for (const char* text : {"top", "top@", "top@2", "top@x"})
        EXPECT_NE(refusal(s, text), "no error") << text;
}

TEST(SceneArgument, ChecksNamesOfObjects) {
    for (const char* name : {"s", "_a", "Crown-2.b"}) EXPECT_TRUE(is_object_name(name)) << name;
    for (const char* name : {"", "1", "a b", "a@b", "a=b", "-a", "\xc3\xa4"})
        EXPECT_FALSE(is_object_name(name)) << name;
    EXPECT_TRUE(is_object_name(std::string(64, 'a')));
    EXPECT_FALSE(is_object_name(std::string(65, 'a')));
}

TEST(SceneArgument, NumbersRoundTripAsText) {
    const Argument a = number(0, 0, Unit::radian);
    for (const double n : {0.1, 1.0 / 3, 1e-30, 12345678.9, -57.29577951308232}) {
        EXPECT_EQ(parse_argument(a, typed(a, {{}, {n}})).numbers[0], n);
    }
}

// Every member of an option struct is an argument, and parsing its default returns the default of the member.
template <class Options>
void expect_defaults_to_come_back(const std::map<std::string, std::string>& renamed = {}) {
    std::vector<Argument> arguments;
    add_options(arguments, Options{}, "x", {}, renamed);
    std::set<std::string> names;
    for (const Argument& a : arguments) EXPECT_TRUE(names.insert(a.name).second) << a.name;
    Options options;
    std::size_t members = 0;
    visit_members(option_fields(options), "x", [&](const std::string& path, const OptionField& member) {
        const auto found = std::ranges::find(arguments, path, &Argument::field);
        ASSERT_NE(found, arguments.end()) << path;
        ++members;
        if (std::holds_alternative<std::optional<Vec3d>*>(member.ref)) {
            EXPECT_TRUE(found->initial.empty()) << path;
            EXPECT_EQ(parse_argument(*found, "1,-2,0.5").numbers, (std::vector<double>{1, -2, 0.5})) << path;
            return;
        }
        const ArgumentValue read = parse_argument(*found, found->initial);
        const auto number = [&] { return in_library_unit(*found, read.numbers.at(0)); };
        if (const auto* real = std::get_if<float*>(&member.ref)) {
            EXPECT_EQ(static_cast<float>(number()), **real) << path;
        } else if (const auto* whole = std::get_if<int*>(&member.ref)) {
            EXPECT_EQ(static_cast<int>(number()), **whole) << path;
        }
    });
    EXPECT_EQ(members, arguments.size());
}

TEST(SceneArgument, DefaultsOfOptionStructsRoundTrip) {
    expect_defaults_to_come_back<GenerateOptions>();
    expect_defaults_to_come_back<MeshOptions>(
        {{"x.project.method", "project_method"}, {"x.project.tolerance", "project_tolerance"}});
    expect_defaults_to_come_back<RenderOptions>();
}

}  // namespace
}  // namespace coppice
