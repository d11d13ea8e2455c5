#pragma once

#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The connected parts of a skeleton: trees, and what hangs loose beside them, as the pieces of a crown whose
/// branches were not seen whole.
struct LooseParts {
    std::vector<NodeId> trees;  ///< their roots, in order; one at least
    std::vector<NodeId> loose;  ///< roots of the other parts, in order
    double length = 0;          ///< [m] of all segments of loose parts
    double share = 0;           ///< of the length of all segments, in [0, 1]
};

/// Tells trees from loose parts. A tree is each part that is at least a quarter as long, by the sum of its
/// segments, as the longest one. So is a shorter part that stands on the ground: it rises over 1.3 m, and its
/// lowest node lies at most 1.3 m, and a quarter of the way, above the lowest node of the nearest of those.
/// O(n log n).
LooseParts find_loose_parts(const Skeleton& skeleton);

/// The parts with these roots as a skeleton, with the same origin and stable ids. There must be at least one,
/// in ascending order. O(n).
Skeleton parts_of(const Skeleton& skeleton, const std::vector<NodeId>& roots);

}  // namespace coppice
