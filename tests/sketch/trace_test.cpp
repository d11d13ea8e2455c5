#include "coppice/sketch/trace/trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coppice/skeleton/measure.h"
#include "coppice/sketch/reconstruct.h"
#include "coppice/sketch/trace/silhouette_internal.h"
#include "errors.h"
#include "sketch/drawn.h"

namespace coppice {
namespace {

using namespace sketch_internal;
using test::error_of;

/// Fills what lies within a radius of a line.
void draw(Mask& mask, PicturePoint a, PicturePoint b, double radius) {
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            const PicturePoint p{x + 0.5, y + 0.5}, ab = b - a;
            const double t = std::clamp(dot(p - a, ab) / dot(ab, ab), 0.0, 1.0);
            if (length(p - (a + ab * t)) < radius) mask.inside[mask.index(x, y)] = 1;
        }
    }
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

TEST(Silhouette, ABarBecomesItsMiddle) {
    Mask mask(100, 40);
    draw(mask, {20, 20.5}, {80, 20.5}, 8);
    const Mask line = thinned(mask, {});
    EXPECT_LT(count(line), 75u);
    EXPECT_GT(count(line), 50u);
    for (int x = 25; x < 75; ++x) EXPECT_TRUE(line.at(x, 20)) << x;
}

TEST(Silhouette, TheLargestPartIsKept) {
    Mask mask(100, 40);
    draw(mask, {10, 20}, {60, 20}, 5);
    const std::size_t bar = count(mask);
    draw(mask, {80, 20}, {85, 20}, 4);
    EXPECT_GT(count(mask), bar);
    EXPECT_EQ(count(largest_part(mask)), bar);
}

TEST(Silhouette, BranchesThatCrossPassEachOther) {
    // A stem with two laterals that cross each other.
    Mask mask(300, 400);
    draw(mask, {100, 390}, {100, 20}, 9);
    draw(mask, {100, 300}, {250, 60}, 5);
    draw(mask, {100, 220}, {290, 180}, 5);
    const std::vector<float> distance = distance_to_outside(mask);
    const auto pieces = pieces_of(graph_of(thinned(mask, {}), distance), mask, distance);
    std::vector<PicturePoint> ends;
    for (const TracedPiece& piece : pieces)
        if (piece.is_tip) ends.push_back(piece.points.back());
    ASSERT_EQ(ends.size(), 3u);
    for (const TracedPiece& piece : pieces) {
        if (!piece.is_tip || piece.points.back().x < 200) continue;
        // The steep one leaves the stem below the flat one.
        const double start = pieces[*piece.before].points.front().y;
        EXPECT_NEAR(start, piece.points.back().y < 100 ? 295 : 220, 15);
    }
}

/// The fork of fork_drawing, with thick branches, as both of its views show it.
std::array<Mask, 2> fork_silhouettes(const std::vector<SketchView>& views) {
    std::array<Mask, 2> out{Mask(400, 320), Mask(400, 320)};
    for (std::size_t v = 0; v < 2; ++v) {
        const auto line = [&](Vec3d a, Vec3d b, double radius) {
            draw(out[v], project(views[v], a), project(views[v], b), radius * 100);
        };
        line({0, 0, 0}, {0, 0, 2}, 0.08);
        line({0, 0, 1}, {0.4, 0.3, 1.5}, 0.04);
        line({0.4, 0.3, 1.5}, {0.6, 0.5, 1.9}, 0.04);
    }
    return out;
}

TEST(Trace, AForkIsFoundInItsSilhouettes) {
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

TEST(Trace, WhatCannotBeTracedIsRefused) {
    const Sketch drawing = test::fork_drawing();
    const auto said = [&](std::vector<SketchView> views, std::array<Mask, 2> masks) {
        return error_of([&] { trace(views, masks); });
    };
    EXPECT_EQ(said({drawing.views[0]}, fork_silhouettes(drawing.views)),
              "trace: two views with a silhouette each are needed");
    EXPECT_EQ(said(drawing.views, {Mask(400, 320), Mask(400, 320)}), "trace: a silhouette shows nothing");
    std::vector<SketchView> sized = drawing.views;
    sized[1].width = 500;
    sized[1].height = 320;
    EXPECT_EQ(said(sized, fork_silhouettes(drawing.views)),
              "trace: the silhouette of 'side' has 400 x 320 pixels, but the view 500 x 320");
    std::vector<SketchView> moved = drawing.views;
    moved[1].t.y += 0.5;
    EXPECT_EQ(said(moved, fork_silhouettes(drawing.views)),
              "trace: no branch of the two silhouettes matches; are these the right cameras?");
    EXPECT_EQ(error_of([] { extent_of(Mask(10, 10), "here"); }), "here: the silhouette shows nothing");
}

TEST(Trace, TheExtentRunsFromTheFootToTheTop) {
    Mask mask(100, 100);
    for (int y = 20; y < 90; ++y)
        for (int x = 40; x < 60; ++x) mask.inside[mask.index(x, y)] = 1;
    const Stroke extent = extent_of(mask, "here");
    EXPECT_EQ(extent.points.front(), (PicturePoint{50, 90}));
    EXPECT_EQ(extent.points.back().y, 20);
}

}  // namespace
}  // namespace coppice
