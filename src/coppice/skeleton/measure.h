#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Measures of a skeleton, summed over its segments, so that overlaps count several times. Sums are in double
/// precision. See ConeUnion for the volume of the union.
struct SkeletonMeasures {
    std::uint32_t nodes = 0;         ///< number of nodes
    std::uint32_t segments = 0;      ///< number of nodes that are not roots
    std::uint32_t trees = 0;         ///< number of roots
    std::uint32_t tips = 0;          ///< nodes without children, including single nodes
    std::uint32_t branch_nodes = 0;  ///< nodes with several children
    std::uint32_t max_children = 0;  ///< maximum number of children of a node
    std::uint32_t max_depth = 0;     ///< maximum number of segments between a root and a node
    double length = 0;               ///< [m] total of all segments
    double longest_path = 0;         ///< [m] from a root along segments
    double shortest_segment = 0;     ///< [m] 0 if there are no segments
    double longest_segment = 0;      ///< [m]
    double volume = 0;         ///< [m^3] of the cones of the segments: laterals begin with their own radius
    double area = 0;           ///< [m^2] lateral area of these cones
    double volume_frusta = 0;  ///< [m^3] of the truncated cones between the radii of parent and node
    double area_frusta = 0;    ///< [m^2] lateral area of these, without the end discs
    double min_radius = 0;     ///< [m]
    double max_radius = 0;     ///< [m]
    Box3 bounds;               ///< [m] of the balls around the nodes, relative to the origin
};

/// Computes the measures. O(n).
SkeletonMeasures measure(const Skeleton& skeleton);

/// Returns the root of the tree of each node. O(n).
std::vector<NodeId> tree_roots(const Skeleton& skeleton);

}  // namespace coppice
