#include "coppice/sketch/reconstruct.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "coppice/base/random.h"
#include "coppice/skeleton/measure.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/sketch/draw.h"
#include "described_options.h"
#include "errors.h"
#include "sketch/drawn.h"

namespace coppice {
namespace {

using test::error_of;
using test::fork_drawing;

SketchResult made(const Sketch& sketch, const SketchOptions& options = {}, const Context& ctx = {}) {
    return reconstruct(sketch, options, "a.sketch.json", ctx);
}

/// Returns the distance [m] from p to the closest node.
double to_node(const Skeleton& s, Vec3d p) {
    double least = 1e9;
    for (const NodeId n : nodes(s)) least = std::min(least, distance(p, Vec3d(s.position(n))));
    return least;
}

/// Returns the mean distance [m] of the nodes of one skeleton from the closest segments of the other.
double mean_off(const Skeleton& reference, const Skeleton& found) {
    double sum = 0;
    for (const NodeId n : nodes(reference)) {
        const Vec3d p(reference.position(n));
        double least = 1e9;
        for (const NodeId m : nodes(found)) {
            if (found.is_root(m)) continue;
            const Segment s = found.segment(m);
            const Vec3d a(s.a), d = Vec3d(s.b) - a;
            const double t = std::clamp(dot(p - a, d) / length_squared(d), 0.0, 1.0);
            least = std::min(least, distance(p, a + d * t));
        }
        sum += least / reference.size();
    }
    return sum;
}

TEST(Reconstruct, DescribesEveryOption) { test::expect_described<SketchOptions>(3); }

TEST(Reconstruct, ForkMatchesItsDrawing) {
    const SketchResult result = made(fork_drawing());
    const Skeleton& s = result.skeleton;
    EXPECT_EQ(s.tree_count(), 1u);
    for (const Vec3d p : {Vec3d{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0.4, 0.3, 1.5}, {0.6, 0.5, 1.9}})
        EXPECT_LT(to_node(s, p), 0.01);  // one pixel
    // 2 m of stem, and 0.707 m and 0.490 m of lateral.
    EXPECT_NEAR(measure(s).length, 2 + std::sqrt(0.5) + std::sqrt(0.24), 0.01);
    // 20 pixels at 100 per metre are a radius of 0.1 m.
    EXPECT_NEAR(s.radius(NodeId(0)), 0.1, 1e-3);
    for (const BranchFit& fit : result.branches) {
        EXPECT_EQ(fit.refused, "");
        EXPECT_NEAR(fit.angle, std::numbers::pi / 2, 1e-9);
        for (const StrokeFit& stroke : fit.strokes) EXPECT_LT(stroke.rms_error, 0.5);
    }
    // Without widths, the lateral begins with 0.6 of the radius of the stem there, 0.075 m.
    EXPECT_TRUE(result.branches[1].guessed_radius);
    EXPECT_FALSE(result.branches[0].guessed_radius);
    for (const NodeId n : nodes(s)) {
        if (!s.is_tip(n) || s.position(n).x < 0.5f) continue;
        EXPECT_NEAR(s.radius(n), 0.3 * 0.075, 1e-3);
    }
}

TEST(Reconstruct, DiametersTakePrecedenceOverWidths) {
    Sketch sketch = fork_drawing();
    sketch.branches[0].diameters = {{0.5, 0.3}};
    EXPECT_NEAR(made(sketch).skeleton.radius(NodeId(0)), 0.25, 1e-6);
}

TEST(Reconstruct, BranchStartsAtTheGivenPosition) {
    Sketch sketch = fork_drawing();
    sketch.branches[1].attach = 0.25;
    EXPECT_LT(to_node(made(sketch, {.tolerance = 0}).skeleton, {0, 0, 0.5}), 1e-3);
}

TEST(Reconstruct, StrokesDrawnFromTheTipAreReversed) {
    const Skeleton straight = made(fork_drawing()).skeleton;
    Sketch sketch = fork_drawing();
    std::ranges::reverse(sketch.branches[1].strokes[0].points);
    const SketchResult result = made(sketch);
    EXPECT_TRUE(result.branches[1].strokes[0].reversed);
    EXPECT_FALSE(result.branches[1].strokes[1].reversed);
    EXPECT_LT(mean_off(straight, result.skeleton), 1e-3);
}

TEST(Reconstruct, HorizontalBranchIsMatchedByItsLength) {
    // Its strokes are along each other's epipolar lines, which therefore give no correspondence.
    Sketch sketch = fork_drawing();
    for (Stroke& stroke : sketch.branches[1].strokes)
        stroke.points = {{200, 200}, {220, 200}, {240, 200}, {260, 200}, {280, 200}};
    const Skeleton s = made(sketch, {.tolerance = 0}).skeleton;
    for (const double d : {0.2, 0.4, 0.6, 0.8}) EXPECT_LT(to_node(s, {d, d, 1}), 0.02);
}

TEST(Reconstruct, TruncatedStrokeIsContinuedByTheOther) {
    const Skeleton tree = random_tree(40, 5);
    const Sketch whole = draw_sketch(tree, choose_views(tree));
    Sketch cut = whole;
    auto& stem = cut.branches[0].strokes[1];
    const std::size_t kept = stem.points.size() * 4 / 5;
    stem.points.resize(kept);
    stem.widths.resize(kept);
    const double length = made(whole).branches[0].length;
    EXPECT_NEAR(made(cut).branches[0].length / length, 1, 0.03);
}

TEST(Reconstruct, ExcludesWrongPoints) {
    const Skeleton tree = random_tree(40, 5);
    Sketch sketch = draw_sketch(tree, choose_views(tree));
    const Skeleton clean = made(sketch).skeleton;
    std::vector<PicturePoint>& points = sketch.branches[0].strokes[0].points;
    points[points.size() / 2].x += 80;
    const SketchResult result = made(sketch);
    EXPECT_GE(result.branches[0].strokes[0].left_out, 1u);
    EXPECT_LT(mean_off(clean, result.skeleton), 0.002);
}

TEST(Reconstruct, UsesThirdViews) {
    const Skeleton tree = random_tree(60, 2);
    std::vector<SketchView> views = choose_views(tree);
    const SketchView between = choose_views(tree, {.angle = 0.8f})[1];
    Sketch three = draw_sketch(tree, {views[0], views[1], between});
    three.views[2].name = "between";
    const SketchResult result = made(three);
    EXPECT_LT(mean_off(tree, result.skeleton), 0.002);
    for (const BranchFit& fit : result.branches) {
        EXPECT_EQ(fit.refused, "");
        EXPECT_EQ(fit.strokes.size(), 3u);
        EXPECT_LT(fit.strokes[2].rms_error, 3);
    }
}

/// Documented accuracy for strokes with a noise of 2 pixels: the length within 3 %, and nodes within 1.5
/// radii on average.
TEST(Reconstruct, FindsTreesWithNoisyStrokes) {
    for (const double degrees : {90.0, 30.0}) {
        const Skeleton tree = random_tree(256, 11);
        const DrawSketchOptions draw{.angle = static_cast<float>(degrees * std::numbers::pi / 180)};
        Sketch sketch = draw_sketch(tree, choose_views(tree, draw), draw);
        const CounterRandom random(7, 0);
        std::uint64_t next = 0;
        for (SketchBranch& branch : sketch.branches)
            for (Stroke& stroke : branch.strokes)
                for (PicturePoint& p : stroke.points) {
                    p.x += random.uniform(next++, -2, 2);
                    p.y += random.uniform(next++, -2, 2);
                }
        const SketchResult result = made(sketch);
        EXPECT_NEAR(measure(result.skeleton).length / measure(tree).length, 1, 0.03) << degrees;
        EXPECT_LT(mean_off(tree, result.skeleton), 1.5 * 0.01) << degrees;  // twigs have a radius of 0.01 m
        EXPECT_TRUE(
            std::ranges::all_of(result.branches, [](const BranchFit& f) { return f.refused.empty(); }));
    }
}

/// Moves points of a sketch: all by up to 2 pixels, and one in twenty by 20 to 60 pixels.
void mess_up(Sketch& sketch) {
    const CounterRandom random(3, 0);
    std::uint64_t next = 0;
    for (SketchBranch& branch : sketch.branches) {
        for (Stroke& stroke : branch.strokes) {
            for (PicturePoint& p : stroke.points) {
                p = p + PicturePoint{random.uniform(next, -2, 2), random.uniform(next + 1, -2, 2)};
                const double far = random.uniform(next + 2, 20, 60),
                             turn = random.uniform(next + 3, 0, 2 * std::numbers::pi);
                if (random.uniform(next + 4, 0, 1) < 0.05)
                    p = p + PicturePoint{far * std::cos(turn), far * std::sin(turn)};
                next += 5;
            }
        }
    }
}

/// With one wrong point in twenty: the length within 3 %, 19 of 20 tips within two of their radii, and hardly
/// any branch refused.
TEST(Reconstruct, FindsTreesWithWrongPoints) {
    double length = 0, tips = 0, found_tips = 0, refused = 0;
    for (const std::uint64_t seed : {21u, 22u, 23u, 24u}) {
        const Skeleton tree = random_tree(256, seed);
        Sketch sketch = draw_sketch(tree, choose_views(tree));
        mess_up(sketch);
        const SketchResult result = made(sketch);
        length += 0.25 * measure(result.skeleton).length / measure(tree).length;
        for (const NodeId n : nodes(tree)) {
            if (!tree.is_tip(n)) continue;
            tips += 1;
            found_tips +=
                to_node(result.skeleton, Vec3d(tree.position(n))) < 2 * double{tree.radius(n)} ? 1 : 0;
        }
        refused += static_cast<double>(
            std::ranges::count_if(result.branches, [](const BranchFit& f) { return !f.refused.empty(); }));
    }
    EXPECT_NEAR(length, 1, 0.03);
    EXPECT_GT(found_tips / tips, 0.95);
    EXPECT_LT(refused / tips, 0.005);
}

TEST(Reconstruct, WrongStartIsDetectedByTheOtherView) {
    Sketch sketch = fork_drawing();
    const Skeleton right = made(sketch).skeleton;
    sketch.branches[1].strokes[0].points[0] = {230, 240};
    const SketchResult result = made(sketch);
    EXPECT_EQ(result.branches[1].refused, "");
    EXPECT_EQ(result.branches[1].strokes[0].left_out, 1u);
    EXPECT_EQ(result.branches[1].strokes[1].left_out, 0u);
    EXPECT_LT(mean_off(right, result.skeleton), 0.01);
    EXPECT_NEAR(measure(result.skeleton).length / measure(right).length, 1, 0.02);
}

TEST(Reconstruct, WrongStartOfAStrokeOfTwoPointsIsExcluded) {
    Sketch sketch = fork_drawing();
    // 0.4 m to the right, 0.3 m to the back and 0.5 m above the middle of the stem.
    sketch.branches[1].strokes[0].points = {{165, 170}, {240, 150}};
    sketch.branches[1].strokes[1].points = {{200, 200}, {230, 150}};
    const SketchResult result = made(sketch, {.tolerance = 0});
    EXPECT_EQ(result.branches[1].refused, "");
    EXPECT_EQ(result.branches[1].strokes[0].left_out, 1u);
    EXPECT_LT(to_node(result.skeleton, {0.4, 0.3, 1.5}), 0.02);
    EXPECT_LT(to_node(result.skeleton, {0, 0, 1}), 0.05);
    EXPECT_NEAR(result.branches[1].length, std::sqrt(0.5), 0.05);
}

/// Returns the error of the length of a tree, and the distance [pixels] of its branches from their strokes,
/// if the second camera is rotated by a degree and its scale is 1 % too large.
std::pair<double, double> with_wrong_camera(bool refine, double degrees) {
    const Skeleton tree = random_tree(256, 1);
    Sketch sketch = draw_sketch(tree, choose_views(tree));
    SketchView& view = sketch.views[1];
    view.r = view.r * rotation_about(normalized(Vec3d{1, 2, 1}) * (degrees * std::numbers::pi / 180));
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) view.k[i][i] *= 1 + 0.01 * degrees;
    const SketchResult result = made(sketch, {.refine_cameras = refine});
    double off = 0, strokes = 0;
    for (const BranchFit& fit : result.branches)
        for (const StrokeFit& stroke : fit.strokes) off += stroke.rms_error, strokes += 1;
    return {measure(result.skeleton).length / measure(tree).length - 1, off / strokes};
}

TEST(Reconstruct, RefinesWrongCameras) {
    const auto [right_length, right_off] = with_wrong_camera(false, 0);
    const auto [wrong_length, wrong_off] = with_wrong_camera(false, 1);
    const auto [length, off] = with_wrong_camera(true, 1);
    EXPECT_GT(std::abs(wrong_length), 0.02);
    EXPECT_GT(wrong_off, 3 * right_off);
    EXPECT_NEAR(length, right_length, 0.005);
    EXPECT_LT(off, 1.2 * right_off);
    // Correct cameras hardly change.
    EXPECT_NEAR(with_wrong_camera(true, 0).first, right_length, 0.003);
}

TEST(Reconstruct, FewBranchesDoNotChangeCameras) {
    const Sketch sketch = fork_drawing();
    const Skeleton as_is = made(sketch).skeleton, refined = made(sketch, {.refine_cameras = true}).skeleton;
    EXPECT_TRUE(std::ranges::equal(as_is.positions(), refined.positions()));
}

TEST(Reconstruct, IsBitIdenticalForAnyNumberOfThreads) {
    const Skeleton tree = random_tree(120, 4);
    const Sketch sketch = draw_sketch(tree, choose_views(tree));
    const Skeleton one = made(sketch, {}, {.threads = 1, .stop = {}, .progress = {}}).skeleton;
    for (const unsigned threads : {2u, 7u}) {
        const Skeleton other = made(sketch, {}, {.threads = threads, .stop = {}, .progress = {}}).skeleton;
        EXPECT_TRUE(std::ranges::equal(one.positions(), other.positions()));
        EXPECT_TRUE(std::ranges::equal(one.radii(), other.radii()));
        EXPECT_TRUE(std::ranges::equal(one.parents(), other.parents()));
    }
}

/// Returns the reason why the lateral of the fork is refused after a change.
std::string refusal(const std::function<void(Sketch&)>& change) {
    Sketch sketch = fork_drawing();
    change(sketch);
    return made(sketch).branches[1].refused;
}

TEST(Reconstruct, ErrorsReportTheBranch) {
    EXPECT_EQ(refusal([](Sketch& s) { s.branches[1].strokes.pop_back(); }),
              "branch 'lateral' (strokes in 'front') is refused: it is drawn in a single view");
    EXPECT_EQ(
        refusal([](Sketch& s) {
            s.branches[1].strokes[1].points = {{300, 250}, {330, 270}, {350, 290}};
        }),
        "branch 'lateral' (strokes in 'front', 'side', 90.0 degrees apart) is refused: its strokes do not "
        "match: their points are not on each other's lines of sight");
    EXPECT_EQ(refusal([](Sketch& s) {
                  for (PicturePoint& p : s.branches[1].strokes[1].points) p = {250, 150};
              }),
              "branch 'lateral' (strokes in 'front', 'side') is refused: all points of its stroke in 'side' "
              "coincide");
}

TEST(Reconstruct, RejectsDescendantsOfARejectedBranch) {
    Sketch sketch = fork_drawing();
    SketchBranch twig = sketch.branches[1];
    twig.name = "twig";
    twig.parent = 1;
    sketch.branches.push_back(twig);
    sketch.branches[1].strokes.pop_back();
    EXPECT_EQ(made(sketch).branches[2].refused,
              "branch 'twig' (strokes in 'front', 'side') is refused: its parent branch was refused");
}

TEST(Reconstruct, RejectsViewsFromOnePosition) {
    const Skeleton tree = random_tree(20, 1);
    const DrawSketchOptions draw{.angle = 0.02f};
    const std::string error = error_of([&] { made(draw_sketch(tree, choose_views(tree, draw), draw)); });
    EXPECT_EQ(error.substr(0, 103),
              "a.sketch.json: no branch could be made; branch 'stem 1' (strokes in 'front', 'side', 1.1 "
              "degrees apart)");
}

TEST(Reconstruct, StemRequiresWidthsOrDiameters) {
    Sketch sketch = fork_drawing();
    for (Stroke& stroke : sketch.branches[0].strokes) stroke.widths.clear();
    EXPECT_EQ(error_of([&] { made(sketch); }),
              "a.sketch.json: branch 'stem' has no parent and therefore needs widths or diameters");
}

TEST(Reconstruct, AcceptsDeeplyNestedBranches) {
    Sketch sketch = fork_drawing();
    for (int i = 0; i < 3000; ++i) {
        SketchBranch next = sketch.branches[1];
        next.name = "b" + std::to_string(i);
        next.parent = static_cast<std::uint32_t>(sketch.branches.size() - 1);
        next.attach = 0;
        sketch.branches.push_back(std::move(next));
    }
    EXPECT_EQ(made(sketch).branches.size(), 3002u);
}

}  // namespace
}  // namespace coppice
