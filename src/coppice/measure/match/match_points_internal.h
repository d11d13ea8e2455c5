#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/base/vec.h"

namespace coppice::measure_internal {

/// Pairs points of `a` with points of `b` one to one, the nearest pairs first; a[i] with a point within
/// reach[i] only. Returns for each point of `a` its point of `b`, or kNoIndex. A point remains unmatched
/// after 32 neighbours that are already matched, which only happens in dense groups of points closer together
/// than their reach. O(n log n).
std::vector<std::uint32_t> match_points(std::span<const Vec3d> a, std::span<const double> reach,
                                        std::span<const Vec3d> b, const Context& ctx);

}  // namespace coppice::measure_internal
