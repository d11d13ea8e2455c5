#include "coppice/sketch/sketch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "errors.h"
#include "sketch/drawn.h"

namespace coppice {
namespace {

using test::error_of;
using test::fork_drawing;

/// Returns the message of `validate` for the fork after a change.
std::string catch_message(const std::function<void(Sketch&)>& change) {
    Sketch sketch = fork_drawing();
    change(sketch);
    return error_of([&] { validate(sketch, "a.sketch.json"); });
}

TEST(Sketch, ErrorsReportTheField) {
    EXPECT_EQ(catch_message([](Sketch&) {}), "no error");
    EXPECT_EQ(catch_message([](Sketch& s) { s.views.pop_back(); }),
              "a.sketch.json: views: a sketch needs at least two");
    EXPECT_EQ(catch_message([](Sketch& s) { s.branches.clear(); }),
              "a.sketch.json: branches: a sketch needs at least one");
    EXPECT_EQ(catch_message([](Sketch& s) { s.views[1].name = "front"; }),
              "a.sketch.json: views[1].name: 'front' is already the name of another one");
    EXPECT_EQ(catch_message([](Sketch& s) { s.branches[0].name = ""; }),
              "a.sketch.json: branches[0].name is missing");
    EXPECT_EQ(catch_message([](Sketch& s) { s.branches[0].strokes[1].points.resize(1); }),
              "a.sketch.json: branches[0].strokes.side.points must contain at least two points");
    EXPECT_EQ(catch_message([](Sketch& s) { s.branches[0].strokes[1].view = 0; }),
              "a.sketch.json: branches[0].strokes.front occurs twice");
    EXPECT_EQ(
        catch_message([](Sketch& s) { s.branches[0].strokes[0].widths = {1}; }),
        "a.sketch.json: branches[0].strokes.front.widths must contain two numbers, or one for each of the "
        "3 points, "
        "not 1");
    EXPECT_EQ(catch_message([](Sketch& s) {
                  s.branches[0].strokes[0].widths = {1, 0};
              }),
              "a.sketch.json: branches[0].strokes.front.widths must be above 0");
    EXPECT_EQ(catch_message([](Sketch& s) { s.branches[1].strokes[0].points[2].x = NAN; }),
              "a.sketch.json: branches[1].strokes.front.points[2] is outside of every picture");
    EXPECT_EQ(catch_message([](Sketch& s) { s.branches[1].attach = 1.5; }),
              "a.sketch.json: branches[1].attach must be between 0 and 1");
    EXPECT_EQ(catch_message([](Sketch& s) { s.branches[0].attach = 0.5; }),
              "a.sketch.json: branches[0].attach needs a parent");
    EXPECT_EQ(catch_message([](Sketch& s) {
                  s.branches[1].diameters = {{0.1, -1}};
              }),
              "a.sketch.json: branches[1].diameters must be above 0");
    EXPECT_EQ(catch_message([](Sketch& s) { s.branches[1].parent = 9; }),
              "a.sketch.json: branches[1].parent: there is no such branch");
    EXPECT_EQ(catch_message([](Sketch& s) { s.branches[0].parent = 1; }),
              "a.sketch.json: branches[0].parent: 'stem' is its own ancestor");
}

}  // namespace
}  // namespace coppice
