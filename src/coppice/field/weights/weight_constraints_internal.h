#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/field/weights/global_weights.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Given points, each with the segment whose surface is nearest; by segment, ascending, in the order given.
/// Throws InvalidInput for a point that is not finite. O(m log n).
std::vector<WeightConstraint> attached_constraints(const Skeleton& skeleton, std::span<const Vec3> points,
                                                   const Context& ctx);

}  // namespace coppice
