#pragma once

#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Connected components of a skeleton: trees and loose components, such as fragments of a crown with branches
/// that were not scanned completely.
struct LooseComponents {
    std::vector<NodeId> trees;  ///< roots of the trees, in order; at least one
    std::vector<NodeId> loose;  ///< roots of the other components, in order
    double length = 0;          ///< [m] total length of the loose components
    double share = 0;           ///< share of the total length of the skeleton, in [0, 1]
};

/// Separates trees from loose components. A component is a tree if its total length is at least a quarter of
/// that of the longest one, or if it is on the ground: it is higher than 1.3 m, and its lowest node is at
/// most 1.3 m plus a quarter of the horizontal distance above the lowest node of the closest of the long
/// components. O(n log n).
LooseComponents find_loose_components(const Skeleton& skeleton);

/// Returns the components with these roots as a skeleton with the same origin and stable ids. Requires at
/// least one root, in ascending order. O(n).
Skeleton extract_parts(const Skeleton& skeleton, const std::vector<NodeId>& roots);

}  // namespace coppice
