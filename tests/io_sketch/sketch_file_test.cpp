#include "coppice/io_sketch/sketch_file.h"

#include <gtest/gtest.h>

#include <string>

#include "errors.h"

namespace coppice {
namespace {

using test::error_of;

/// A file with a stem from two sides, with one text replaced by another.
std::string file_with(const std::string& from = "", const std::string& to = "") {
    std::string text = R"({"format": "coppice-sketch", "version": 1, "views": [
        {"name": "front", "image": "a.png", "width": 400, "height": 300, "K": [[100, 0, 200], [0, 100, 150], [0, 0, 1]],
         "R": [[1, 0, 0], [0, 0, -1], [0, 1, 0]], "t": [0, 1, 5], "distortion": [0.1, 0, 0, 0]},
        {"name": "side", "orthographic": "side", "pixels_per_metre": 100, "origin": [200, 300]}],
      "branches": [{"name": "twig", "parent": "stem", "attach": 0.5, "diameters": [0.1, 0.05],
                    "strokes": {"side": {"points": [[200, 200], [220, 150]]}, "front": {"points": [[200, 150], [210, 100]]}}},
                   {"name": "stem", "strokes": {"front": {"points": [[200, 300], [200, 100]], "widths": [10, 5]},
                                                "side": {"points": [[200, 300], [200, 100]]}}}]})";
    if (!from.empty()) text.replace(text.find(from), from.size(), to);
    return text;
}

std::string catch_message(const std::string& from, const std::string& to) {
    return error_of([&] { parse_sketch(file_with(from, to), "a.sketch.json"); });
}

TEST(SketchFile, ReadsAllFields) {
    const Sketch sketch = parse_sketch(file_with(), "a.sketch.json");
    ASSERT_EQ(sketch.views.size(), 2u);
    EXPECT_EQ(sketch.views[0].image, "a.png");
    EXPECT_EQ(sketch.views[0].width, 400);
    EXPECT_EQ(sketch.views[0].distortion[0], 0.1);
    EXPECT_EQ(sketch.views[1].projection, Projection::orthographic);
    ASSERT_EQ(sketch.branches.size(), 2u);
    EXPECT_EQ(sketch.branches[0].parent, 1u);  // a branch may precede its parent
    EXPECT_EQ(sketch.branches[0].attach, 0.5);
    EXPECT_EQ(sketch.branches[0].strokes[0].view, 0u);
    EXPECT_EQ(sketch.branches[0].strokes[1].points[1], (PicturePoint{220, 150}));
    EXPECT_EQ(sketch.branches[1].strokes[0].widths, (std::vector<double>{10, 5}));
}

TEST(SketchFile, ReadsBackItsOutput) {
    const Sketch sketch = parse_sketch(file_with(), "a.sketch.json");
    const std::string text = encode_sketch(sketch);
    const Sketch again = parse_sketch(text, "again");
    EXPECT_EQ(encode_sketch(again), text);
    EXPECT_EQ(project(again.views[1], {1, 2, 3}), project(sketch.views[1], {1, 2, 3}));
    EXPECT_EQ(again.branches[0].diameters, sketch.branches[0].diameters);
}

TEST(SketchFile, ReportsErrors) {
    EXPECT_EQ(catch_message("\"views\": [", "\"views\": [,"), "a.sketch.json:1: this is not valid JSON");
    EXPECT_EQ(catch_message("coppice-sketch", "coppice-skeleton"),
              "a.sketch.json: this JSON is not a sketch: it needs \"format\": \"coppice-sketch\"");
    EXPECT_EQ(catch_message("\"t\": [0, 1, 5]", "\"t\": [0, 1]"),
              "a.sketch.json: views[0].t must be a list of 3 numbers, not 2");
    EXPECT_EQ(catch_message("\"attach\"", "\"atach\""),
              "a.sketch.json: branches[0] has no field 'atach'; there are name, parent, attach, strokes, "
              "diameters");
    EXPECT_EQ(catch_message("\"parent\": \"stem\"", "\"parent\": \"trunk\""),
              "a.sketch.json: branches[0].parent names no branch: 'trunk'");
    EXPECT_EQ(catch_message("{\"side\": {", "{\"left\": {"),
              "a.sketch.json: branches[0].strokes.left names no view: 'left'");
    EXPECT_EQ(catch_message("[220, 150]", "[220, \"150\"]"),
              "a.sketch.json: branches[0].strokes.side.points[1] must be a list of numbers");
    EXPECT_EQ(catch_message("\"orthographic\": \"side\"", "\"orthographic\": \"inside\""),
              "a.sketch.json: views[1].orthographic must be one of front, back, side, left, top");
    EXPECT_EQ(catch_message("\"orthographic\": \"side\", ", ""),
              "a.sketch.json: views[1] needs the camera's K, R and t, or colmap, phenomenal, photograph or "
              "orthographic");
    EXPECT_EQ(catch_message("\"pixels_per_metre\": 100", "\"pixels_per_metre\": 0"),
              "a.sketch.json: views[1].pixels_per_metre must be above 0");
    EXPECT_EQ(catch_message("\"distortion\": [0.1, 0, 0, 0]", "\"distortion\": [0.1]"),
              "a.sketch.json: views[0].distortion must be k1, k2, p1, p2 and, if known, k3");
    EXPECT_EQ(catch_message("\"width\": 400", "\"width\": 1.5"),
              "a.sketch.json: views[0].width must be a whole number of pixels");
    EXPECT_EQ(
        catch_message("\"widths\": [10, 5]", "\"widths\": [10, 5, 1]"),
        "a.sketch.json: branches[1].strokes.front.widths must contain two numbers, or one for each of the "
        "2 points, "
        "not 3");
    EXPECT_EQ(error_of<Unsupported>(
                  [&] { parse_sketch(file_with("\"version\": 1", "\"version\": 2"), "a.sketch.json"); }),
              "a.sketch.json: version 2 of coppice-sketch is newer than this program");
}

TEST(SketchFile, AcceptsRotationVectors) {
    const std::string text =
        file_with("\"R\": [[1, 0, 0], [0, 0, -1], [0, 1, 0]]", "\"rvec\": [1.5707963267948966, 0, 0]");
    EXPECT_NEAR(length(parse_sketch(text, "a").views[0].r * Vec3d{0, 1, 0} - Vec3d{0, 0, 1}), 0, 1e-12);
}

TEST(SketchFile, HeightSufficesForTwoDrawings) {
    // The stem is 200 pixels high in both.
    std::string text = file_with(R"(, "pixels_per_metre": 100, "origin": [200, 300])", "");
    EXPECT_EQ(error_of([&] { parse_sketch(text, "a.sketch.json"); }), "a.sketch.json: height is missing");
    text.replace(text.find("\"views\""), 0, "\"height\": 4, ");
    EXPECT_EQ(project(parse_sketch(text, "a").views[1], {0, 0, 4}), (PicturePoint{200, 100}));
}

TEST(SketchFile, IsRecognizedByItsName) {
    EXPECT_TRUE(is_sketch_name("oak.sketch.json"));
    EXPECT_FALSE(is_sketch_name("oak.json"));
    EXPECT_FALSE(is_sketch_name("sketch.json"));
}

}  // namespace
}  // namespace coppice
