#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Returns for each form the height [m] above the foot at which the lowest large branch leaves the main axis:
/// one longer than a tenth of the height of the tree. Forms are those of the first trees in the order of
/// their roots. Returns the height of the tree if there is no such branch. O(n).
std::vector<double> crown_bases(const Skeleton& skeleton, std::span<const StemForm> forms);

/// Convex hull of a crown, in plan view and in space.
struct Crown {
    std::vector<Vec3d> outline;  ///< [m] corners in plan view, counter-clockwise, in the coordinate frame of
                                 ///< the file, at the height of the crown base
    double area = 0;             ///< [m^2] area of the outline
    double max_width = 0;        ///< [m] maximum distance of two corners of the outline
    TriMesh hull;                ///< closed; without faces if the points are coplanar
    double hull_area = 0;        ///< [m^2] area of the hull
    double hull_volume = 0;      ///< [m^3] volume of the hull

    /// Returns the diameter [m] of the circle with the area of the outline.
    double diameter() const;
};

/// Measures the points above a height [m] (z in the coordinate frame of the file). The outline is empty for
/// fewer than three points, or if all are on a vertical plane. Expected O(n log n). Throws Cancelled.
Crown measure_crown(const PointSet& points, double above, const Context& ctx = {});

/// Measures the nodes of each tree of a skeleton, in the order of the roots, above the height of each.
std::vector<Crown> measure_crowns(const Skeleton& skeleton, std::span<const double> above,
                                  const Context& ctx = {});

}  // namespace coppice
