#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/node_join.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// What parting changed, counted.
struct PartReport {
    std::uint32_t absorbed = 0;  ///< nodes inside the union about a branch node, taken into it
    std::uint32_t advanced =
        0;  ///< branches moved on to a later node, since they part from their leader only beyond it
    std::uint32_t bundled =
        0;  ///< pairs of siblings that part from each other last, given a node of their own
    std::uint32_t swallowed = 0;  ///< tips that lie inside other branches
};

/// A skeleton for the cage: like the given one, but its branch nodes lie where the tubes part.
struct PartResult {
    Skeleton skeleton;           ///< what the cage is made of
    std::vector<NodeId> source;  ///< per node: the node of the given skeleton it stands for
    std::vector<NodeId> tube;  ///< per node of the given skeleton: the new node whose tube wraps its segment
    /// Roots of one child that stand for a root of several, ascending: a tree has no flat base there.
    std::vector<NodeId> round_roots;
    std::vector<NodeJoin> joins;  ///< those given, of the new nodes, by `end`
    PartReport report;            ///< what was done
};

/// A branch that leaves at an acute angle stays inside its leader for a while: two tubes that began at the
/// branch node would cross each other until then. So each branch is moved along its leader to the node after
/// which it parts; nodes that lie inside the union about a branch node join it; and each branch node is
/// shifted towards its farthest crotch; a root stays, and a node of its own takes its branches. Topology
/// changes, but every tip that shows stays, and the surface is projected on the field of the given skeleton.
/// O(n k) for at most k children at a node.
///
/// `joins` (by `end`) name tips that end in a node of another branch: there they are laterals like others.
PartResult part_branches(const Skeleton& skeleton, std::span<const NodeJoin> joins, const Context& ctx);

}  // namespace coppice
