#pragma once

#include <vector>

#include "coppice/sketch/line_internal.h"
#include "coppice/sketch/reconstruct.h"

namespace coppice::sketch_internal {

/// Scores: -2 times the logarithm of a likelihood ratio, so that squared distances in units of the noise are
/// scores too. One point in twenty is wrong, uniformly distributed within some hundred pixels; one stroke in
/// ten ends too early.
/// @{
constexpr double kWrong = 13;
constexpr double kShort = 5;
/// @}

/// A point on a branch, between two of its nodes.
struct Place {
    std::size_t node = 0;  ///< the previous node
    double along = 0;      ///< parameter in [0, 1] between this node and the next one
};

/// The axis of a branch in space.
struct Axis {
    std::vector<Vec3d> positions;  ///< [m] two or more; empty if the branch was rejected
    std::vector<double> radii;     ///< [m]
    Place start;                   ///< start on the parent axis, if there is one

    Vec3d at(Place place) const;          ///< [m]
    double radius_at(Place place) const;  ///< [m]
};

/// A sketch with its global properties.
struct SketchFacts {
    const Sketch& sketch;
    std::span<const SketchView> views;  ///< views of the sketch, without distortion
    const SketchOptions& options;
    Hand hand;
};

/// Computes the axis of a branch; the axis of its parent, if any, must be known. Stores the result in `fit`.
/// If the branch is rejected, `fit` contains the reason and the axis is empty.
Axis make_axis(const SketchFacts& facts, std::uint32_t branch, const Axis* parent, BranchFit& fit,
               const Context& ctx);

/// Returns the point of the parent axis at which a branch with these strokes starts: the one that all images
/// show near the first points of the strokes, or behind them.
Place place_on(const Axis& parent, std::span<const SketchView> views, std::span<const Stroke> strokes,
               std::span<const Line> lines);

}  // namespace coppice::sketch_internal
