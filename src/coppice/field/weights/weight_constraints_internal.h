#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/field/weights/global_weights.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Assigns each point to the segment with the nearest surface; sorted by segment, otherwise in the given
/// order. Throws InvalidInput for a point that is not finite. O(m log n).
std::vector<WeightConstraint> attached_constraints(const Skeleton& skeleton, std::span<const Vec3> points,
                                                   const Context& ctx);

}  // namespace coppice
