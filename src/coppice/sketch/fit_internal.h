#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/sketch/line_internal.h"
#include "coppice/sketch/match_internal.h"

namespace coppice::sketch_internal {

/// A stroke and the camera of its picture, which does not distort.
struct Sight {
    const SketchView* view;
    const Line* line;
};

/// A node of a branch in space.
struct AxisNode {
    Vec3d position;                 ///< [m]
    std::array<double, 2> along{};  ///< [pixels] along both strokes that were matched; NaN beyond their match
    std::array<int, 2> point{-1, -1};  ///< of these strokes that it is; -1 = none
    double off = 0;                    ///< squares of how far off its strokes it is, in what they stray
    double odd = 0;  ///< how ill it fits its strokes and how sharply it turns, as a sum of squares
};

/// The axis of a branch.
struct FittedAxis {
    std::vector<AxisNode> nodes;  ///< none where lines of sight do not meet before the cameras
};

/// What the fit starts from.
struct FitInput {
    std::array<Sight, 2> matched;   ///< the two strokes that were matched
    std::span<const Sight> others;  ///< of further views
    const Match* match;             ///< of the two
    std::optional<Vec3d> start;     ///< [m] where the axis has to begin
    double bend = 0.8;              ///< [rad] that a branch turns by, about, from its start to its end
};

/// The axis of a branch that looks most like its strokes: a node for every point of both that were matched;
/// the sum of squares of how far it lies from them, in what they stray, and of how sharply it bends, is
/// least, where points far off count little. Gauss-Newton with damping. O(nodes) for each of at most 30
/// steps.
FittedAxis fit_axis(const FitInput& input, const Context& ctx);

/// [rad] between two lines of sight.
double angle_between(const ViewRay& a, const ViewRay& b);

/// The point half way where two lines of sight come nearest to each other; none where they are parallel.
std::optional<Vec3d> meet(const ViewRay& a, const ViewRay& b);

}  // namespace coppice::sketch_internal
