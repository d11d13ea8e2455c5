#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice::measure_internal {

inline constexpr std::uint32_t kNoMatch = std::numeric_limits<std::uint32_t>::max();

/// Pairs points of `a` with points of `b`, each with one at most, the nearest pairs first; a[i] with none
/// farther away than reach[i]. Returns for each of `a` its point of `b`, or kNoMatch. A point gives up after
/// 32 neighbours that others have taken, which only crowds of points closer together than their reach can
/// bring about. O(n log n).
std::vector<std::uint32_t> match_points(std::span<const Vec3d> a, std::span<const double> reach,
                                        std::span<const Vec3d> b, const Context& ctx);

}  // namespace coppice::measure_internal
