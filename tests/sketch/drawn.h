#pragma once

#include <gtest/gtest.h>

#include "coppice/sketch/sketch.h"

namespace coppice::test {

/// A stem of 2 m with a lateral at half its height, drawn from the front and from the side at 100 pixels per
/// metre.
inline Sketch fork_drawing() {
    Sketch sketch;
    sketch.views = {drawing_view(DrawingSide::front, 100, {200, 300}),
                    drawing_view(DrawingSide::side, 100, {200, 300})};
    sketch.views[0].name = "front";
    sketch.views[1].name = "side";
    const auto stroke = [&](std::uint32_t view, std::vector<Vec3d> points, std::vector<double> widths) {
        Stroke out{.view = view, .points = {}, .widths = std::move(widths)};
        for (const Vec3d p : points) out.points.push_back(project(sketch.views[view], p));
        return out;
    };
    const std::vector<Vec3d> stem{{0, 0, 0}, {0, 0, 1}, {0, 0, 2}},
        lateral{{0, 0, 1}, {0.4, 0.3, 1.5}, {0.6, 0.5, 1.9}};
    sketch.branches.push_back({.name = "stem",
                               .parent = {},
                               .strokes = {stroke(0, stem, {20, 10}), stroke(1, stem, {20, 10})},
                               .attach = {},
                               .diameters = {}});
    sketch.branches.push_back({.name = "lateral",
                               .parent = 0,
                               .strokes = {stroke(0, lateral, {}), stroke(1, lateral, {})},
                               .attach = {},
                               .diameters = {}});
    return sketch;
}

}  // namespace coppice::test
