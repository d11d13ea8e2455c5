#pragma once

#include <cstddef>

#include "coppice/base/box.h"
#include "coppice/base/column.h"
#include "coppice/base/vec.h"

namespace coppice {

/// Points in space: what a crown is filled with, a tree grows towards, or a scanner saw. Positions are
/// finite. The order means nothing but is kept by whatever changes a set.
struct PointSet {
    Buffer<Vec3> positions;  ///< [m] relative to origin
    Vec3d origin;            ///< [m] keeps the digits of points far from zero; writers add it back

    std::size_t size() const { return positions.size(); }  ///< number of points
    bool empty() const { return positions.empty(); }       ///< there are none
    /// [m] in the frame of the file it came from
    Vec3d world(std::size_t i) const { return origin + Vec3d(positions[i]); }
    friend bool operator==(const PointSet&, const PointSet&) = default;  ///< bit by bit but for -0
};

/// The box of the positions, relative to the origin; empty for a set without points.
Box3 bounds(const PointSet& points);

/// The points of a, then those of b, relative to the origin of a, to which those of b are rounded. A set
/// without points lends no origin. O(n).
PointSet merged(const PointSet& a, const PointSet& b);

}  // namespace coppice
