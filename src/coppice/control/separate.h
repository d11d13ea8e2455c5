#pragma once

#include <cstdint>

#include "coppice/base/context.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A skeleton whose branches no longer run through each other.
struct SeparateResult {
    Skeleton skeleton;
    std::uint32_t crossings = 0;  ///< pairs of segments that crossed at first
    std::uint32_t moved = 0;      ///< nodes that lie elsewhere than before
};

/// Bends branches around each other where their axes come nearer than `depth` times the sum of their radii
/// although they are far apart along the skeleton: a tube around such a branch would pierce the other, and no
/// closed surface of sphere type without self-intersections exists. The thinner branch gives way sideways,
/// and the bend fades out along it within a few times its size. Shallower overlaps are left to the contact of
/// the field. depth 0 changes nothing, nor does a tangle, which has more than one crossing in fifty nodes.
/// Roots and topology stay. O(n log n) for the search unless most boxes of segments overlap.
SeparateResult separate_crossings(const Skeleton& skeleton, float depth, const Context& ctx);

}  // namespace coppice
