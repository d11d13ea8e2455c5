#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/implicit/shape/profile.h"
#include "coppice/implicit/shape/variational.h"

namespace coppice {

/// A point of a closed line in a plane, and the direction out of the area it bounds.
struct OrientedPoint {
    Vec2d position;  ///< [m]
    Vec2d normal;    ///< not zero; its length has no meaning
};

/// The variational curve through points: where the smoothest function is 0 that is 0 at the points and rises
/// along their normals. It is f(p) = sum of w r^2 log r, r = |p - center|, plus a linear function, which of
/// all such has the least integral of second derivatives, as a bent thin plate [Turk2002]. The points come in
/// any order; there may be several contours and holes, as the normals ask for.
///
/// The contours are traced through cells of 1/192 of the box: corners lie on the curve, straight lines
/// between them within 1e-4 of its size where it bends no more sharply than with a radius of 1/30 of that,
/// and what is smaller than a cell may be missed. Beyond the margin around the points' box the area ends.
///
/// Throws InvalidInput for less than 3 points or more than 1,000, points that coincide, normals without
/// direction, and points and normals that all lie on one line. O(n^3), and n for each of 37,000 corners:
/// 1,000 points take some 2 s of one core.
Profile variational_profile(std::span<const OrientedPoint> points, const VariationalOptions& options = {},
                            const Context& ctx = {});

/// Normals for points that follow each other around one area, either way: across the chord of their
/// neighbours. Throws InvalidInput for less than 3 points, and where such a chord has no length.
std::vector<OrientedPoint> with_normals(std::span<const Vec2d> points);

}  // namespace coppice
