#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "coppice/sketch/sketch.h"

namespace coppice::sketch_internal {

/// A stroke ready for work: in the picture without distortion, without repeated and wrong points.
struct Line {
    std::vector<PicturePoint> points;  ///< two or more, all apart
    std::vector<double> along;         ///< [pixels] of every point from the first
    std::vector<double> widths;        ///< [pixels] at every point; empty where none were drawn
    std::vector<int> drawn;            ///< which of the stroke's points each is; -1 = none of them
    double noise = 1;                  ///< [pixels] how far points stray across the line, about
    std::size_t left_out = 0;          ///< points taken for wrong

    double length() const { return along.back(); }  ///< [pixels]
    PicturePoint at(double s) const;                ///< of a length along the line, held within it
    double width_at(double s) const;                ///< the same of the widths
    PicturePoint direction(double s) const;         ///< unit, of the part about s
    /// The length along the line, within [low, high], that is nearest to a point.
    double nearest(PicturePoint p, double low, double high) const;
};

/// How somebody draws, by all strokes of a sketch.
struct Hand {
    double noise = 1;   ///< [pixels] how far points stray across their lines, about
    double piece = 0;   ///< [pixels] median way from point to point
    double spread = 1;  ///< standard deviation of the logarithm of the ways above the median
};

/// Medians over all strokes, so that the points that are wrong tell nothing. `noise` [pixels] goes before
/// what is measured; 0 = none. O(points).
Hand hand_of(const Sketch& sketch, double noise);

/// Takes out points that leap from the line and back, and measures how far the others stray; of a stroke of
/// few points `hand` tells it. `noise` [pixels] goes before both; 0 = none. Without `clean` every point
/// stays. O(n).
Line line_of(const SketchView& view, const Stroke& stroke, const Hand& hand, double noise, bool clean = true);

/// The line through these points, of which two at least must be apart, as they are.
Line line_through(std::vector<PicturePoint> points);
/// The same line with one more point before its first.
Line with_start(const Line& line, PicturePoint start);
/// The same line with its first point moved; it stays as it is where its second one lies there.
Line with_first(const Line& line, PicturePoint first);
/// The same line without a point of it, which counts as wrong; it needs another one.
Line without_point(const Line& line, std::size_t point);
/// The same line from its other end.
Line reversed(const Line& line);

}  // namespace coppice::sketch_internal
