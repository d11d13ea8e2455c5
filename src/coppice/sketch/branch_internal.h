#pragma once

#include <vector>

#include "coppice/sketch/line_internal.h"
#include "coppice/sketch/reconstruct.h"

namespace coppice::sketch_internal {

/// How odd something is: -2 times the logarithm of how likely it is against what is usual, so that squares of
/// how far points stray, in what they stray, are of its kind. One point in twenty is wrong and lies anywhere
/// within some hundred pixels; one stroke in ten stops short of what it shows.
/// @{
constexpr double kWrong = 13;
constexpr double kShort = 5;
/// @}

/// A place on a branch: between two of its nodes.
struct Place {
    std::size_t node = 0;  ///< the one before it
    double along = 0;      ///< in [0, 1] of the way to the next one
};

/// A branch in space.
struct Axis {
    std::vector<Vec3d> positions;  ///< [m] two or more; none when it was refused
    std::vector<double> radii;     ///< [m]
    Place start;                   ///< where it leaves its parent, if it has one

    Vec3d at(Place place) const;          ///< [m]
    double radius_at(Place place) const;  ///< [m]
};

/// A sketch, and what is known of it as a whole.
struct SketchFacts {
    const Sketch& sketch;
    std::span<const SketchView> views;  ///< of the sketch, without distortion
    const SketchOptions& options;
    Hand hand;
};

/// Makes the axis of a branch whose parent's, if it has one, is made. What it finds goes into `fit`, also why
/// the branch is refused: then the axis is empty.
Axis make_axis(const SketchFacts& facts, std::uint32_t branch, const Axis* parent, BranchFit& fit,
               const Context& ctx);

/// Where on its parent a branch starts that begins as the strokes do: where all pictures show the parent's
/// axis near the starts, or behind them.
Place place_on(const Axis& parent, std::span<const SketchView> views, std::span<const Stroke> strokes,
               std::span<const Line> lines);

}  // namespace coppice::sketch_internal
