#pragma once

#include <optional>
#include <vector>

#include "coppice/sketch/line_internal.h"

namespace coppice::sketch_internal {

/// Corresponding points of two strokes of a branch.
struct Pair {
    double s;  ///< [pixels] along the first line
    double t;  ///< [pixels] along the second line
};

/// Correspondence of two strokes; s and t are non-decreasing.
struct Match {
    std::vector<Pair> pairs;  ///< at least two
    double cost = 0;          ///< per sample: about 1/2 if strokes match within their noise
    double share = 0;         ///< matched fraction of a stroke, the smaller of both, in [0, 1]
};

/// Returns the fundamental matrix of two views: corresponding points satisfy x2^T F x1 = 0, for all
/// projections.
Matrix3 fundamental_matrix(const SketchView& first, const SketchView& second);

/// Returns the Sampson distance [pixels] of two points from corresponding to each other.
double epipolar_distance(const Matrix3& f, PicturePoint first, PicturePoint second);

/// Returns the Sampson distance, signed by the side of the epipolar line.
double signed_epipolar_distance(const Matrix3& f, PicturePoint first, PicturePoint second);

/// Matches two whole strokes by dynamic programming over samples of both: the order is preserved, points are
/// near each other's epipolar lines, and where these are parallel to the stroke both advance at the same
/// rate. Ends that only one stroke has remain unmatched, except the starts if `starts_meet`. O(samples^2),
/// with 48 samples of each stroke.
Match match_lines(const Line& first, const Line& second, const Matrix3& f, bool starts_meet);

}  // namespace coppice::sketch_internal
