#pragma once

#include <optional>
#include <vector>

#include "coppice/sketch/line_internal.h"

namespace coppice::sketch_internal {

/// The same point of a branch in two strokes.
struct Pair {
    double s;  ///< [pixels] along the first line
    double t;  ///< [pixels] along the second line
};

/// Which points of two strokes are the same; neither s nor t ever falls.
struct Match {
    std::vector<Pair> pairs;  ///< of samples, two or more
    double cost = 0;          ///< per sample: about 1/2 where strokes match within their noise
    double share = 0;         ///< of the stroke of which less is matched, in [0, 1]
};

/// Lines of points that may be the same, one picture's in the other: x2^T F x1 = 0, whatever the projections.
Matrix3 fundamental_matrix(const SketchView& first, const SketchView& second);

/// [pixels] how far two points are from being the same, across the lines of the other one (Sampson).
double epipolar_distance(const Matrix3& f, PicturePoint first, PicturePoint second);

/// The same with a sign that tells on which side.
double signed_epipolar_distance(const Matrix3& f, PicturePoint first, PicturePoint second);

/// Matches two strokes as wholes by dynamic programming over samples of both: order is kept, points lie near
/// each other's epipolar line, and where that runs along the stroke both go on at one pace. Ends that only
/// one stroke has stay unmatched; not at the start when `starts_meet`. O(samples^2), at most 64 each.
Match match_lines(const Line& first, const Line& second, const Matrix3& f, bool starts_meet);

}  // namespace coppice::sketch_internal
