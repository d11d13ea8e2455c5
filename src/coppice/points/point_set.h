#pragma once

#include <cstddef>

#include "coppice/base/box.h"
#include "coppice/base/column.h"
#include "coppice/base/vec.h"

namespace coppice {

/// Points in space: a filled crown, attractors of a tree, or a laser scan. Positions are finite. The order
/// has no meaning, but every operation preserves it.
struct PointSet {
    Buffer<Vec3> positions;  ///< [m] relative to origin
    Vec3d origin;  ///< [m] keeps the precision of points far from zero; writers add it to the positions

    std::size_t size() const { return positions.size(); }  ///< number of points
    bool empty() const { return positions.empty(); }       ///< whether there are no points
    /// Returns the position [m] in the coordinate frame of the source file.
    Vec3d world(std::size_t i) const { return origin + Vec3d(positions[i]); }
    friend bool operator==(const PointSet&,
                           const PointSet&) = default;  ///< compares bits, except the sign of zero
};

/// Returns the bounding box of the positions, relative to the origin; empty for a set without points.
Box3 bounds(const PointSet& points);

/// Returns the points of a, then those of b, relative to the origin of a, to which the positions of b are
/// rounded. The origin of a set without points is ignored. O(n).
PointSet merged(const PointSet& a, const PointSet& b);

}  // namespace coppice
