#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// [m] For each form, which are those of the first trees in the order of their roots, the height above the
/// foot at which the lowest large branch leaves the main axis: one that is longer than a tenth of the height
/// of the tree. The height of the tree where there is none. O(n).
std::vector<double> crown_bases(const Skeleton& skeleton, std::span<const StemForm> forms);

/// The convex hull of a crown, seen from above and in space.
struct Crown {
    std::vector<Vec3d> outline;  ///< [m] corners seen from above, counter-clockwise, in the frame of the
                                 ///< file, at the height of its base
    double area = 0;             ///< [m^2] within the outline
    double greatest_width = 0;   ///< [m] between the two corners of the outline that are farthest apart
    TriMesh hull;                ///< closed; without faces where the points lie in one plane
    double hull_area = 0;        ///< [m^2]
    double hull_volume = 0;      ///< [m^3]

    /// [m] of the circle that has the area of the outline
    double diameter() const;
};

/// Measures the points above a height [m] (z in the frame of the file). Fewer than three of them, or points
/// above each other, have no outline. Expected O(n log n). Throws Cancelled.
Crown measure_crown(const PointSet& points, double above, const Context& ctx = {});

/// The same of the nodes of each tree of a skeleton, in the order of the roots, above a height for each.
std::vector<Crown> measure_crowns(const Skeleton& skeleton, std::span<const double> above,
                                  const Context& ctx = {});

}  // namespace coppice
