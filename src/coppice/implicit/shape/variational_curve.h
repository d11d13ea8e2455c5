#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/implicit/shape/profile.h"
#include "coppice/implicit/shape/variational.h"

namespace coppice {

/// A point of a closed line in a plane, and the direction out of the bounded area.
struct OrientedPoint {
    Vec2d position;  ///< [m]
    Vec2d normal;    ///< not zero; its length is ignored
};

/// Returns the variational curve through points: the zeros of the smoothest function that is 0 at the points
/// and increases along their normals. It is f(p) = sum of w r^2 log r, r = |p - center|, plus a linear
/// function, which has the smallest integral of squared second derivatives of all such functions, as a bent
/// thin plate [Turk2002]. The points may be in any order; there may be several contours and holes, depending
/// on the normals.
///
/// The contours are traced through cells of 1/192 of the box: corners are on the curve, straight lines
/// between them within 1e-4 of its size if the radius of curvature is at least 1/30 of that, and features
/// smaller than a cell may be missed. The area ends at the margin around the points' box.
///
/// Throws InvalidInput for less than 3 points or more than 1,000, points that coincide, normals without
/// direction, and points and normals that are all on one line. O(n^3), and O(n) for each of 37,000 corners:
/// 1,000 points take about 2 s of one core.
Profile variational_profile(std::span<const OrientedPoint> points, const VariationalOptions& options = {},
                            const Context& ctx = {});

/// Returns normals for consecutive points around one area, in either direction: perpendicular to the chord of
/// their neighbours. Throws InvalidInput for less than 3 points, and if such a chord has no length.
std::vector<OrientedPoint> with_normals(std::span<const Vec2d> points);

}  // namespace coppice
