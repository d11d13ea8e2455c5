#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "coppice/sketch/sketch.h"

namespace coppice::sketch_internal {

/// A preprocessed stroke: in the undistorted image, without repeated and wrong points.
struct Line {
    std::vector<PicturePoint> points;  ///< at least two, all distinct
    std::vector<double> along;         ///< [pixels] arc length of every point
    std::vector<double> widths;        ///< [pixels] at every point; empty if not drawn
    std::vector<int> drawn;            ///< index of each point in the stroke; -1 = not drawn
    double noise = 1;                  ///< [pixels] approximate standard deviation of points across the line
    std::size_t left_out = 0;          ///< number of points removed as wrong

    double length() const { return along.back(); }  ///< [pixels]
    PicturePoint at(double s) const;                ///< point at an arc length, clamped to the line
    double width_at(double s) const;                ///< width at an arc length
    PicturePoint direction(double s) const;         ///< unit vector, direction of the segment at s
    /// Returns the arc length in [low, high] of the closest point to p.
    double nearest(PicturePoint p, double low, double high) const;
};

/// Drawing style of a user: statistics of all strokes of a sketch.
struct Hand {
    double noise = 1;   ///< [pixels] approximate standard deviation of points across their lines
    double piece = 0;   ///< [pixels] median distance between consecutive points
    double spread = 1;  ///< standard deviation of the logarithm of the distances above the median
};

/// Computes medians over all strokes, which are robust against wrong points. A positive `noise` [pixels]
/// replaces the measured one. O(points).
Hand estimate_hand(const Sketch& sketch, double noise);

/// Removes outliers from a stroke and measures the noise of the remaining points; short strokes use the noise
/// of `hand`. A positive `noise` [pixels] replaces both. Without `clean` every point is kept. O(n).
Line make_line(const SketchView& view, const Stroke& stroke, const Hand& hand, double noise,
               bool clean = true);

/// Returns the line through unmodified points, at least two of which must be distinct.
Line line_through(std::vector<PicturePoint> points);
/// Returns the line with an additional point before its first.
Line with_start(const Line& line, PicturePoint start);
/// Returns the line with its first point moved; unchanged if the second point is there.
Line with_first(const Line& line, PicturePoint first);
/// Returns the line without one of its points, which is counted as wrong; at least one point must remain.
Line without_point(const Line& line, std::size_t point);
/// Returns the line in reverse order.
Line reversed(const Line& line);

}  // namespace coppice::sketch_internal
