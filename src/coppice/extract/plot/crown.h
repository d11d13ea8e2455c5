#pragma once

#include "coppice/extract/stem/stem_form.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// [m] Above the foot, where the lowest large branch leaves the main axis of the first tree: one that is
/// longer than a tenth of the height of the tree. The height of the tree where there is none. O(n).
double crown_base(const Skeleton& skeleton, const StemForm& form);

/// [m^2] Area of the convex hull, seen from above, of the points above a height (z in the frame of the file).
/// O(n log n).
double crown_area(const PointSet& points, double above);

}  // namespace coppice
