#include "coppice/sketch/trace/trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/skeleton/measure.h"
#include "coppice/sketch/reconstruct.h"
#include "coppice/sketch/trace/hull_internal.h"
#include "coppice/sketch/trace/silhouette_internal.h"
#include "errors.h"
#include "sketch/drawn.h"

namespace coppice {
namespace {

using namespace sketch_internal;
using test::error_of;

/// Fills the pixels within a radius of a line.
void draw(Mask& mask, PicturePoint a, PicturePoint b, double radius) {
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            const PicturePoint p{x + 0.5, y + 0.5}, ab = b - a;
            const double t = std::clamp(dot(p - a, ab) / dot(ab, ab), 0.0, 1.0);
            if (length(p - (a + ab * t)) < radius) mask.inside[mask.index(x, y)] = 1;
        }
    }
}

/// Returns all points of a sketch.
std::vector<PicturePoint> collect_points(const Sketch& sketch) {
    std::vector<PicturePoint> out;
    for (const SketchBranch& branch : sketch.branches)
        for (const Stroke& stroke : branch.strokes)
            out.insert(out.end(), stroke.points.begin(), stroke.points.end());
    return out;
}

std::size_t count(const Mask& mask) { return static_cast<std::size_t>(std::ranges::count(mask.inside, 1)); }

TEST(Silhouette, DistancesAreExact) {
    Mask mask(9, 7);
    for (int y = 1; y < 6; ++y)
        for (int x = 1; x < 8; ++x) mask.inside[mask.index(x, y)] = 1;
    mask.inside[mask.index(4, 3)] = 0;
    const std::vector<float> distance = distance_to_outside(mask);
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            double least = 1e9;
            for (int v = -1; v <= mask.height; ++v)
                for (int u = -1; u <= mask.width; ++u)
                    if (!mask.at(u, v)) least = std::min(least, std::hypot(u - x, v - y));
            EXPECT_FLOAT_EQ(distance[mask.index(x, y)], static_cast<float>(least)) << x << " " << y;
        }
    }
}

TEST(Silhouette, ThinnedBarIsItsMiddleLine) {
    Mask mask(100, 40);
    draw(mask, {20, 20.5}, {80, 20.5}, 8);
    const Mask line = thinned(mask, {});
    EXPECT_LT(count(line), 75u);
    EXPECT_GT(count(line), 50u);
    for (int x = 25; x < 75; ++x) EXPECT_TRUE(line.at(x, 20)) << x;
}

TEST(Silhouette, LargestPartIsPreserved) {
    Mask mask(100, 40);
    draw(mask, {10, 20}, {60, 20}, 5);
    const std::size_t bar = count(mask);
    draw(mask, {80, 20}, {85, 20}, 4);
    EXPECT_GT(count(mask), bar);
    EXPECT_EQ(count(largest_part(mask)), bar);
}

TEST(Silhouette, IntersectingBranchesContinueStraight) {
    // A stem with two laterals that cross each other.
    Mask mask(300, 400);
    draw(mask, {100, 390}, {100, 20}, 9);
    draw(mask, {100, 300}, {250, 60}, 5);
    draw(mask, {100, 220}, {290, 180}, 5);
    const std::vector<float> distance = distance_to_outside(mask);
    const auto sections = find_paths(build_graph(thinned(mask, {}), distance), mask, distance);
    std::vector<PicturePoint> ends;
    for (const TracedSection& section : sections)
        if (section.is_tip) ends.push_back(section.points.back());
    ASSERT_EQ(ends.size(), 3u);
    for (const TracedSection& section : sections) {
        if (!section.is_tip || section.points.back().x < 200) continue;
        // The steep one leaves the stem below the flat one.
        const double start = sections[*section.before].points.front().y;
        EXPECT_NEAR(start, section.points.back().y < 100 ? 295 : 220, 15);
    }
}

/// Returns the silhouettes of fork_drawing with thick branches, in the given views.
std::vector<Mask> fork_silhouettes(const std::vector<SketchView>& views) {
    std::vector<Mask> out(views.size(), Mask(400, 320));
    for (std::size_t v = 0; v < views.size(); ++v) {
        const auto line = [&](Vec3d a, Vec3d b, double radius) {
            draw(out[v], project(views[v], a), project(views[v], b), radius * 100);
        };
        line({0, 0, 0}, {0, 0, 2}, 0.08);
        line({0, 0, 1}, {0.4, 0.3, 1.5}, 0.04);
        line({0.4, 0.3, 1.5}, {0.6, 0.5, 1.9}, 0.04);
    }
    return out;
}

/// Returns the views of fork_drawing, one from between them, and one from the left of the front.
std::vector<SketchView> four_views() {
    std::vector<SketchView> views = test::fork_drawing().views;
    const double c = std::sqrt(0.5);
    for (const double side : {1.0, -1.0}) {
        views.push_back(views[0]);
        views.back().name = "view " + std::to_string(views.size());
        views.back().r = {{{c, side * c, 0}, {0, 0, -1}, {-side * c, c, 0}}};
    }
    return views;
}

TEST(Trace, FindsAForkInItsSilhouettes) {
    const Sketch drawing = test::fork_drawing();
    const TraceResult traced = trace(drawing.views, fork_silhouettes(drawing.views));
    ASSERT_EQ(traced.sketch.branches.size(), 2u);
    EXPECT_EQ(traced.tips, (std::vector<std::uint32_t>{2, 2}));
    EXPECT_NO_THROW(validate(traced.sketch, "traced"));
    const Skeleton s = reconstruct(traced.sketch, {}, "traced").skeleton;
    EXPECT_EQ(s.tree_count(), 1u);
    EXPECT_NEAR(measure(s).length, 2 + std::sqrt(0.5) + std::sqrt(0.24), 0.15);
    EXPECT_NEAR(s.radius(NodeId(0)), 0.08, 0.01);
    double nearest = 1;
    for (const Vec3 p : s.positions()) nearest = std::min(nearest, distance(Vec3d(p), Vec3d{0.6, 0.5, 1.9}));
    EXPECT_LT(nearest, 0.06);
}

TEST(Trace, SilhouetteFieldsReturnTheDepthInside) {
    Mask mask(100, 80);
    for (int y = 20; y < 60; ++y)
        for (int x = 30; x < 70; ++x) mask.inside[mask.index(x, y)] = 1;
    const SilhouetteField field(mask);
    EXPECT_EQ(field.inside_by({50.5, 30.5}), 10.5);  // the upper edge is at y = 20
    EXPECT_EQ(field.inside_by({28.5, 30.5}), -1.5);  // the left edge is at x = 30
    EXPECT_LE(*field.inside_by({5.5, 30.5}), -20);   // at most 24.5
    EXPECT_GE(*field.inside_by({5.5, 30.5}), -24.5);
    EXPECT_EQ(field.inside_by({-1, 30}), std::nullopt);
    EXPECT_EQ(field.inside_by({50, 80}), std::nullopt);
}

TEST(Trace, HullHasTheWidthOfTheStem) {
    const std::vector<SketchView> views = four_views();
    const std::vector<Mask> masks = fork_silhouettes(views);
    std::vector<SilhouetteField> fields(masks.begin(), masks.end());
    const Hull hull = compute_hull(views, fields, {});
    EXPECT_LE(hull.size, 0.015);  // pixels are 1 cm
    double widest = 0;
    for (std::uint32_t i = 0; i < hull.cells.size(); ++i) {
        const Vec3d p = hull.center(i);
        EXPECT_GT(p.z, -0.1);
        EXPECT_LT(p.z, 2.1);
        if (p.z > 0.3 && p.z < 0.7) widest = std::max(widest, hull.clearance[i]);
    }
    EXPECT_NEAR(widest, 0.08, 0.01);
}

TEST(Trace, FindsAForkInFourSilhouettes) {
    const std::vector<SketchView> views = four_views();
    const std::vector<Mask> masks = fork_silhouettes(views);
    const TraceResult traced = trace(views, masks);
    ASSERT_EQ(traced.sketch.branches.size(), 2u);
    EXPECT_EQ(traced.sketch.branches[1].strokes.size(), 4u);
    const Skeleton s = reconstruct(traced.sketch, {}, "traced").skeleton;
    EXPECT_EQ(s.tree_count(), 1u);
    // Its ends are round: 0.08 more at both ends of the stem, and 0.04 more at the end of the branch.
    EXPECT_NEAR(measure(s).length, 2 + std::sqrt(0.5) + std::sqrt(0.24) + 0.2, 0.15);
    EXPECT_NEAR(s.radius(NodeId(0)), 0.08, 0.015);
    double nearest = 1;
    for (const Vec3 p : s.positions()) nearest = std::min(nearest, distance(Vec3d(p), Vec3d{0.6, 0.5, 1.9}));
    EXPECT_LT(nearest, 0.06);
    Context one;
    one.threads = 1;
    EXPECT_EQ(collect_points(trace(views, masks, one).sketch), collect_points(traced.sketch));
}

TEST(Trace, RemovesPiecesThatExplainNothing) {
    // Two bars in the front view and two in the side view: four bars would have the same silhouettes.
    const std::vector<SketchView> views = test::fork_drawing().views;
    Hull hull;
    hull.size = 0.01;
    std::vector<HullPath> sections;
    const auto bar = [&](double x, double y) {
        HullPath section{.cells = {}, .before = kNoIndex, .is_tip = true};
        for (int k = 0; k < 60; ++k) {
            section.cells.push_back(static_cast<std::uint32_t>(hull.cells.size()));
            hull.cells.push_back({static_cast<int>(100 * x), static_cast<int>(100 * y), 100 + k});
            hull.clearance.push_back(0.03);
        }
        sections.push_back(section);
    };
    bar(0.5, 0.5), bar(-0.5, -0.5), bar(0.5, -0.5), bar(-0.5, 0.5);
    std::vector<Mask> masks(2, Mask(400, 320));
    for (std::size_t v = 0; v < 2; ++v)
        for (const double at : {-0.5, 0.5})
            draw(masks[v], project(views[v], {at, at, 1}), project(views[v], {at, at, 1.6}), 4);
    const std::vector<SilhouetteField> fields(masks.begin(), masks.end());
    EXPECT_EQ(explaining(hull, sections, views, fields, masks, {}).size(), 2u);
}

TEST(Trace, RejectsInvalidInput) {
    const Sketch drawing = test::fork_drawing();
    const auto catch_message = [&](std::vector<SketchView> views, std::vector<Mask> masks) {
        return error_of([&] { trace(views, masks); });
    };
    EXPECT_EQ(catch_message({drawing.views[0]}, fork_silhouettes(drawing.views)),
              "trace: at least two views with a silhouette each are needed");
    EXPECT_EQ(catch_message(drawing.views, {Mask(400, 320), Mask(400, 320)}), "trace: a silhouette is empty");
    std::vector<SketchView> sized = drawing.views;
    sized[1].width = 500;
    sized[1].height = 320;
    EXPECT_EQ(catch_message(sized, fork_silhouettes(drawing.views)),
              "trace: the silhouette of 'side' has 400 x 320 pixels, but the view has 500 x 320");
    std::vector<SketchView> moved = drawing.views;
    moved[1].t.y += 0.5;
    EXPECT_EQ(catch_message(moved, fork_silhouettes(drawing.views)),
              "trace: no branch of the two silhouettes matches; check that the cameras are correct");
    std::vector<SketchView> four = four_views();
    std::vector<Mask> shown = fork_silhouettes(four);
    four[3].t.x += 1;
    EXPECT_EQ(catch_message(four, shown),
              "trace: the silhouettes have no common space; check that the cameras are correct");
    shown[2] = Mask(400, 320);
    EXPECT_EQ(catch_message(four, shown), "trace: a silhouette is empty");
    shown = fork_silhouettes(four = {drawing.views[0], drawing.views[0], drawing.views[0]});
    EXPECT_EQ(catch_message(four, shown),
              "trace: all views look the same way, so that the depth of the tree is unknown; add a view from "
              "another side");
    EXPECT_EQ(error_of([] { compute_extent(Mask(10, 10), "here"); }), "here: the silhouette is empty");
}

TEST(Trace, ExtentIsFromTheFootToTheTop) {
    Mask mask(100, 100);
    for (int y = 20; y < 90; ++y)
        for (int x = 40; x < 60; ++x) mask.inside[mask.index(x, y)] = 1;
    const Stroke extent = compute_extent(mask, "here");
    EXPECT_EQ(extent.points.front(), (PicturePoint{50, 90}));
    EXPECT_EQ(extent.points.back().y, 20);
}

}  // namespace
}  // namespace coppice
