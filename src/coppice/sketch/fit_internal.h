#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/sketch/line_internal.h"
#include "coppice/sketch/match_internal.h"

namespace coppice::sketch_internal {

/// A stroke with the undistorted camera of its image.
struct Sight {
    const SketchView* view;
    const Line* line;
};

/// A node of the axis of a branch.
struct AxisNode {
    Vec3d position;  ///< [m]
    std::array<double, 2>
        along{};  ///< [pixels] position along the two matched strokes; NaN outside their match
    std::array<int, 2> point{-1, -1};  ///< index of the corresponding point of each stroke; -1 = none
    double off = 0;                    ///< sum of squared distances from its strokes in units of the noise
    double odd = 0;  ///< score of the distances from the strokes and of the turn, a sum of squares
};

/// The axis of a branch.
struct FittedAxis {
    std::vector<AxisNode> nodes;  ///< empty if lines of sight do not meet in front of the cameras
};

/// Input of fit_axis.
struct FitInput {
    std::array<Sight, 2> matched;   ///< the two matched strokes
    std::span<const Sight> others;  ///< strokes of further views
    const Match* match;             ///< match of the two strokes
    std::optional<Vec3d> start;     ///< [m] fixed start of the axis
    double bend = 0.8;              ///< [rad] standard turn of a branch from its start to its end
};

/// Fits the axis of a branch to its strokes, with a node for every point of both matched strokes. Minimizes
/// the sum of squared distances from the strokes in units of the noise and of squared turns, with reduced
/// weight of outliers. Damped Gauss-Newton. O(nodes) for each of at most 30 steps.
FittedAxis fit_axis(const FitInput& input, const Context& ctx);

/// Returns the angle [rad] between two lines of sight.
double angle_between(const ViewRay& a, const ViewRay& b);

/// Returns the midpoint of the shortest segment between two lines of sight; none if they are parallel.
std::optional<Vec3d> meet(const ViewRay& a, const ViewRay& b);

}  // namespace coppice::sketch_internal
