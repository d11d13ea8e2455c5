#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Figures of a skeleton, segment by segment: what overlaps counts twice. Sums are in double precision. For
/// the volume of the union see ConeUnion.
struct SkeletonMeasures {
    std::uint32_t nodes = 0;         ///< number of nodes
    std::uint32_t segments = 0;      ///< number of nodes that are no roots
    std::uint32_t trees = 0;         ///< number of roots
    std::uint32_t tips = 0;          ///< nodes without children; a single node is one
    std::uint32_t branch_nodes = 0;  ///< nodes with several children
    std::uint32_t max_children = 0;  ///< the most that a node has
    std::uint32_t max_depth = 0;     ///< segments between a root and the deepest node
    double length = 0;               ///< [m] of all segments
    double longest_path = 0;         ///< [m] from a root along segments
    double shortest_segment = 0;     ///< [m] 0 when there are no segments
    double longest_segment = 0;      ///< [m]
    double volume = 0;           ///< [m^3] of the cones of the segments: laterals start with their own radius
    double area = 0;             ///< [m^2] lateral area of these cones
    double volume_frusta = 0;    ///< [m^3] of the truncated cones between the radii of parent and node
    double area_frusta = 0;      ///< [m^2] lateral area of these, without the discs at their ends
    double least_radius = 0;     ///< [m]
    double greatest_radius = 0;  ///< [m]
    Box3 bounds;                 ///< [m] of the balls about the nodes, relative to the origin
};

/// O(n).
SkeletonMeasures measure(const Skeleton& skeleton);

/// Per node, the root of its tree. O(n).
std::vector<NodeId> tree_roots(const Skeleton& skeleton);

}  // namespace coppice
