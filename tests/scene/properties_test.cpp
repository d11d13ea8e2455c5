#include <gtest/gtest.h>

#include "coppice/io_points/reader.h"
#include "coppice/scene/properties_internal.h"
#include "coppice/scene/save.h"
#include "coppice/scene/scene.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "paths.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

class SceneProperties : public test::FolderTest {
  protected:
    void write(const std::string& name, const std::string& text) const { write_file(folder_ / name, text); }
    Scene scene() const { return Scene({.folder = folder_}); }
    std::string refusal(const std::string& line, const std::string& properties) const {
        write("p.props", properties);
        Scene s = scene();
        s.run("sphere s");
        return test::error_of<Error>([&] { s.run(line); });
    }
};

const PointSet& get_points(const Scene& scene, const std::string& name) {
    return std::get<PointSet>(scene.state().objects.at({ObjectKind::points, name})->value);
}

double min_distance(const PointSet& set) {
    double least = 1e300;
    for (std::size_t i = 0; i < set.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) least = std::min(least, length(set.world(i) - set.world(k)));
    return least;
}

TEST_F(SceneProperties, ALineIsANameAndAValue) {
    const auto found =
        parse_properties("# disks\ncount = 500\n\ndistance: 0.1 # m\nseed 7\nname=\"b\"\n", "p");
    ASSERT_EQ(found.size(), 4u);
    EXPECT_EQ(found[0].name + "|" + found[0].value, "count|500");
    EXPECT_EQ(found[1].name + "|" + found[1].value, "distance|0.1");
    EXPECT_EQ(found[1].line, 4u);
    EXPECT_EQ(found[2].name + "|" + found[2].value, "seed|7");
    EXPECT_EQ(found[3].value, "b");
    EXPECT_EQ(test::error_of<InvalidInput>([] { parse_properties("a=1\ncount =\n", "p.props"); }),
              "p.props:2: an option and its value are required here, as in count = 500");
}

// All command lines of the thesis, as printed there: sections 4.1, 7.0.1 and 7.1.
TEST_F(SceneProperties, EveryLineOfTheThesisRunsAsPrinted) {
    write("poisson.props", "distance = 9\ncount = 400\n");
    Scene s = scene();
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(folder_);  // folder of points.txt
    s.run_text("sphere s1\nline s2\ndiff s1 s2 s3\n", "4.1");
    s.run_text("sphere s\nscale s 50 80 50\npointset gen s poisson poisson.props\nsave pointset points.txt\n",
               "7.0.1");
    // The surfaces and points that section 7.1 assumes.
    s.run_text("sphere crown\npointset gen crown count=100\nsphere secondary radius=2", "7.1");
    s.run_text("pointset thin crown secondary 80\n", "7.1");
    std::filesystem::current_path(before);
    const PointSet saved = read_points(folder_ / "points.txt");
    EXPECT_EQ(saved.size(), 400u);
    EXPECT_GE(min_distance(saved), 8.999);
    EXPECT_EQ(get_points(s, "crown").size(), 20u);
    const std::string page = read_file(source_dir() / "docs/user/scenes.md");
    for (const char* line : {"sphere s1", "line s2", "diff s1 s2 s3", "sphere s", "scale s 50 80 50",
                             "pointset gen s poisson poisson.props", "save pointset points.txt",
                             "pointset thin crown secondary 80"})
        EXPECT_NE(page.find("| `" + std::string(line) + "` |"), std::string::npos) << line;
}

TEST_F(SceneProperties, ArgumentsTakePrecedenceOverTheFile) {
    write("p.props", "pattern = uniform\ncount = 50\nseed = 3\ncurve = 0.6,1\ncurve = 0.7,1\n");
    Scene s = scene();
    s.run_text("sphere s\npointset gen s properties=p.props count=70\npointset gen s jittered p.props name=j",
               "x");
    EXPECT_EQ(get_points(s, "s").size(), 70u);
    const std::string recipe = make_recipe(s.state());
    EXPECT_NE(recipe.find("pointset generate s uniform"), std::string::npos);
    EXPECT_NE(recipe.find("pointset generate s jittered"), std::string::npos);
    EXPECT_NE(recipe.find("curve=0.6,1 curve=0.7,1"), std::string::npos);
    // The recipe contains all options and does not depend on the file.
    EXPECT_EQ(recipe.find("props"), std::string::npos);
    Scene again({.files = false});
    again.run_text(recipe, "recipe");
    EXPECT_EQ(get_points(again, "s"), get_points(s, "s"));
}

TEST_F(SceneProperties, ErrorsReportFileLineAndOption) {
    EXPECT_NE(refusal("pointset gen s poisson p.props", "\ncuont = 5")
                  .find("p.props:2: pointset generate has no option 'cuont'; did you mean count?"),
              std::string::npos);
    EXPECT_NE(refusal("pointset gen s poisson p.props", "count = many").find("p.props:1: count takes"),
              std::string::npos);
    EXPECT_NE(refusal("pointset gen s poisson p.props", "count=1\ncount=2").find("given twice"),
              std::string::npos);
    EXPECT_NE(
        refusal("pointset gen s poisson p.props", "solid = s").find("is not allowed in a file of options"),
        std::string::npos);
    EXPECT_NE(refusal("pointset gen s poisson missing.props", "").find("missing.props"), std::string::npos);
    Scene closed({.files = false});
    closed.run("sphere s");
    EXPECT_THROW(closed.run("pointset gen s poisson p.props"), IoError);
}

TEST_F(SceneProperties, SavePointsetWritesTheLastCreatedPoints) {
    Scene s = scene();
    EXPECT_NE(test::error_of<Error>([&] { s.run("save pointset a.xyz"); }).find("no points yet"),
              std::string::npos);
    s.run_text("sphere a\npointset gen a count=30\npointset gen a count=40 name=b\nlimb t 0,0,0 0,0,1", "x");
    s.run("save pointset " + quoted_word((folder_ / "a.ply").string()));
    EXPECT_EQ(read_points(folder_ / "a.ply").size(), 40u);
    EXPECT_THROW(s.run("save pointset a.obj"), InvalidInput);
    // An object of that name takes precedence.
    s.run("pointset gen a count=20 name=pointset");
    s.run("pointset gen a count=50 name=c");
    s.run("save pointset " + quoted_word((folder_ / "b.xyz").string()));
    EXPECT_EQ(read_points(folder_ / "b.xyz").size(), 20u);
}

}  // namespace
}  // namespace coppice
