#include "coppice/sketch/draw.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coppice/skeleton/measure.h"
#include "coppice/skeleton/random_tree.h"
#include "described_options.h"
#include "errors.h"

namespace coppice {
namespace {

TEST(Draw, DescribesEveryOption) { test::expect_described<DrawSketchOptions>(); }

TEST(Draw, EveryAxisIsABranchInsideItsImages) {
    const Skeleton tree = random_tree(200, 3);
    const std::size_t tips = measure(tree).tips;
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        const DrawSketchOptions options{.projection = projection, .size = 800};
        const Sketch sketch = draw_sketch(tree, choose_views(tree, options), options);
        EXPECT_NO_THROW(validate(sketch, "drawn"));
        EXPECT_EQ(sketch.branches.size(), tips);  // each branch ends in one tip
        for (const SketchBranch& branch : sketch.branches) {
            for (const Stroke& stroke : branch.strokes) {
                EXPECT_EQ(stroke.widths.size(), stroke.points.size());
                for (const PicturePoint p : stroke.points)
                    EXPECT_TRUE(p.x > 0 && p.x < 800 && p.y > 0 && p.y < 800);
            }
        }
    }
}

TEST(Draw, ViewsHaveTheGivenAngle) {
    const Skeleton tree = random_tree(20, 1);
    const auto views = choose_views(tree, {.angle = static_cast<float>(std::numbers::pi / 6)});
    const Vec3d a{views[0].r[2][0], views[0].r[2][1], views[0].r[2][2]},
        b{views[1].r[2][0], views[1].r[2][1], views[1].r[2][2]};
    EXPECT_NEAR(dot(a, b), std::cos(std::numbers::pi / 6), 1e-6);
    EXPECT_NEAR(a.y, 1, 1e-12);  // the front looks along +y
}

TEST(Draw, RejectsASkeletonWithoutSegments) {
    const Skeleton dot({NodeId()}, {{0, 0, 0}}, {1});
    EXPECT_EQ(test::error_of([&] { draw_sketch(dot, choose_views(dot)); }),
              "a skeleton without segments cannot be drawn");
}

}  // namespace
}  // namespace coppice
