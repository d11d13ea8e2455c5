#include "messy_strokes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "draws.h"

namespace coppice::bench {
namespace {

void cut(Stroke& stroke, Draws& draws) {
    const double share = draws.uniform(0.05, 0.2);
    const bool at_tip = draws.uniform(0, 1) < 0.5;
    double total = 0, before = 0;
    for (std::size_t i = 1; i < stroke.points.size(); ++i)
        total += length(stroke.points[i] - stroke.points[i - 1]);
    Stroke kept{.view = stroke.view, .points = {}, .widths = {}};
    for (std::size_t i = 0; i < stroke.points.size(); ++i) {
        if (i > 0) before += length(stroke.points[i] - stroke.points[i - 1]);
        if (at_tip ? before > (1 - share) * total : before < share * total) continue;
        kept.points.push_back(stroke.points[i]);
        kept.widths.push_back(stroke.widths[i]);
    }
    if (kept.points.size() >= 2) stroke = std::move(kept);
}

/// Removes the wrong points; a stroke with fewer than two correct points is removed.
void take_out(Stroke& stroke, const std::vector<bool>& wrong) {
    if (std::ranges::count(wrong, false) < 2) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < wrong.size(); ++i) {
        if (wrong[i]) continue;
        stroke.points[kept] = stroke.points[i];
        stroke.widths[kept++] = stroke.widths[i];
    }
    stroke.points.resize(kept);
    stroke.widths.resize(kept);
}

}  // namespace

Sketch messed_up(Sketch sketch, const Mess& mess, std::uint64_t seed) {
    Draws draws(seed);
    for (SketchBranch& branch : sketch.branches) {
        if (draws.uniform(0, 1) < mess.cut) cut(branch.strokes[draws.uniform(0, 1) < 0.5 ? 0 : 1], draws);
        for (Stroke& stroke : branch.strokes) {
            std::vector<bool> wrong(stroke.points.size(), false);
            for (std::size_t i = 0; i < stroke.points.size(); ++i) {
                PicturePoint& p = stroke.points[i];
                p = p + PicturePoint{draws.uniform(-mess.jitter, mess.jitter),
                                     draws.uniform(-mess.jitter, mess.jitter)};
                if (draws.uniform(0, 1) >= mess.wrong) continue;
                const double far = draws.uniform(20, 60), turn = draws.uniform(0, 2 * std::numbers::pi);
                p = p + PicturePoint{far * std::cos(turn), far * std::sin(turn)};
                wrong[i] = true;
            }
            if (mess.known) take_out(stroke, wrong);
        }
    }
    return sketch;
}

void misplace(SketchView& view, double error, std::uint64_t seed) {
    if (error == 0) return;
    Draws draws(seed + 1000);
    const double up = draws.uniform(-1, 1), round = draws.uniform(0, 2 * std::numbers::pi);
    const double level = std::sqrt(1 - up * up), angle = error * std::numbers::pi / 180;
    view.r = view.r * rotation_about(Vec3d{level * std::cos(round), level * std::sin(round), up} * angle);
    const double scale = 1 + (draws.uniform(0, 1) < 0.5 ? -0.01 : 0.01) * error;
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) view.k[i][i] *= scale;
}

}  // namespace coppice::bench
