#include "coppice/sketch/snapshot.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/skeleton/measure.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/sketch/draw.h"
#include "coppice/sketch/reconstruct.h"
#include "errors.h"
#include "sketch/drawn.h"

namespace coppice {
namespace {

TEST(Snapshot, ADrawingIsScaledByTheHeight) {
    // The stem of 2 m is 200 pixels high, and its base is at (200, 300).
    const SketchView view =
        snapshot_view(test::fork_drawing(), 1, {.side = DrawingSide::side}, 2, "views[1]");
    EXPECT_EQ(view.name, "side");
    EXPECT_DOUBLE_EQ(view.k[0][0], 100);
    EXPECT_EQ(project(view, {0, 0, 0}), (PicturePoint{200, 300}));
}

TEST(Snapshot, PhotographDeterminesItsCamera) {
    const Skeleton tree = random_tree(120, 6);
    // Two cameras at a distance of 16 m and a height of 1.5 m that do not point directly at the stem.
    std::vector<SketchView> views(2);
    for (const bool side : {false, true}) {
        SketchView& v = views[side ? 1 : 0];
        v.name = side ? "side" : "front";
        v.width = 3000;
        v.height = 4000;
        v.k = {{{5000, 0, 1500}, {0, 5000, 2000}, {0, 0, 1}}};
        v.r = drawing_view(side ? DrawingSide::side : DrawingSide::front, 1, {}).r;
        v.t = {side ? 0.3 : -0.2, 1.5, 16};
    }
    Sketch sketch = draw_sketch(tree, views);
    double top = 0;
    for (const Vec3 p : tree.positions()) top = std::max(top, double{p.z});
    const double field_of_view = 2 * std::atan(2000.0 / 5000);  // across the longer side, 4000 pixels
    for (const std::uint32_t v : {0u, 1u}) {
        const DrawingSide side = v == 0 ? DrawingSide::front : DrawingSide::side;
        sketch.views[v] =
            snapshot_view(sketch, v, {.side = side, .field_of_view = field_of_view}, top, "view");
        // The highest point leans out by less than 1 m in 16.
        EXPECT_LT(distance(sketch.views[v].t, views[v].t), 1);
    }
    const SketchResult result = reconstruct(sketch, {}, "tree");
    EXPECT_NEAR(measure(result.skeleton).length / measure(tree).length, 1, 0.05);
    for (const BranchFit& fit : result.branches) EXPECT_EQ(fit.refused, "");
}

TEST(Snapshot, RejectsInputWithoutAScale) {
    const auto catch_message = [](const Sketch& sketch, const Snapshot& snapshot, double height) {
        return test::error_of([&] { snapshot_view(sketch, 0, snapshot, height, "views[0]"); });
    };
    Sketch sketch = test::fork_drawing();
    EXPECT_EQ(catch_message(sketch, {}, 0), "views[0]: the height of the tree must be above 0 metres");
    EXPECT_EQ(catch_message(sketch, {.side = DrawingSide::top}, 2),
              "views[0]: the height of the tree is not visible from the top");
    EXPECT_EQ(catch_message(sketch, {.field_of_view = 1}, 2),
              "views[0]: field_of_view needs the width and height of the picture");
    for (SketchBranch& branch : sketch.branches)
        for (Stroke& stroke : branch.strokes)
            for (PicturePoint& p : stroke.points) p.y = 300;
    EXPECT_EQ(catch_message(sketch, {}, 2), "views[0]: no point in this view is above the base of its stem");
    sketch.branches.erase(sketch.branches.begin());  // the lateral keeps its parent
    EXPECT_EQ(catch_message(sketch, {}, 2),
              "views[0]: no stem has a stroke in this view, so that its scale is unknown; draw the stem");
}

}  // namespace
}  // namespace coppice
