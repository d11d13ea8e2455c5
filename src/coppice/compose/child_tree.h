#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A branch with its descendants, extracted from a tree [Zhu2015, figure 18] into its own frame: the branch
/// node is its root at the origin, its initial direction is +z, and the axis of the parent branch continues
/// towards +x, so that it can be inserted into another parent branch.
struct ChildTree {
    Skeleton skeleton;        ///< one tree; its root has one child
    float parent_radius = 0;  ///< [m] radius of the parent branch at the branch node; > 0
    float inclination = 0;    ///< [rad] angle between its direction and the parent branch, in [0, pi]
    bool leads = false;       ///< whether it continues its parent branch, as the thickest child of the node
    std::uint32_t source_node = 0;  ///< its first node after the branch node, in the source skeleton
};

/// Sizes of a child tree.
struct ChildTreeMeasures {
    double length = 0;         ///< [m] total length of all segments
    double volume = 0;         ///< [m^3] of the truncated cones between nodes
    double extent = 0;         ///< [m] distance from the root to the farthest node
    std::uint32_t nodes = 0;   ///< number of nodes, including the root
    std::uint32_t tips = 0;    ///< number of nodes without children
    std::uint32_t orders = 0;  ///< 1 without laterals, 2 if it has laterals, 3 if these have laterals, ...
    float radius = 0;          ///< [m] at its first node after the branch node
};

/// Computes the sizes of a child tree. O(n).
ChildTreeMeasures measure(const ChildTree& tree);

/// Selects the branches to extract.
struct ChildTreeOptions {
    bool leaders = true;   ///< includes branches that continue their parent branch
    float min_length = 0;  ///< [m] minimum total length of all segments
};

/// Lists the members for front ends.
void list_fields(ChildTreeOptions& o, FieldList& list);

/// Extracts every child branch of every branch node, in order of the nodes. Throws InvalidInput if an option
/// is out of range. Time and memory are proportional to the size of the result; a node is copied once for
/// each branch node on its path to the root.
std::vector<ChildTree> child_trees(const Skeleton& skeleton, const ChildTreeOptions& options = {},
                                   const Context& ctx = {});

/// Returns whether a branch begins at a node: it is the child of a node that has several.
bool begins_child_tree(const Skeleton& skeleton, NodeId node);

/// Extracts only the branches that begin at `first`: nodes that are children of branch nodes. Throws
/// InvalidInput naming a node that is not.
std::vector<ChildTree> child_trees_at(const Skeleton& skeleton, const std::vector<NodeId>& first);

}  // namespace coppice
