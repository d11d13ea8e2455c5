#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/node_join.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Counts of the changes by separate_branches().
struct SeparationReport {
    std::uint32_t merged_nodes = 0;  ///< nodes inside the union around a branch node, merged into it
    /// branches moved to a later node because they separate from their leader only beyond it
    std::uint32_t shifted_nodes = 0;
    /// pairs of siblings that separate from each other last, given a node of their own
    std::uint32_t paired_nodes = 0;
    std::uint32_t hidden_tips = 0;  ///< tips inside other branches
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const SeparationReport& r, Visitor&& visit) {
    visit("merged_nodes", r.merged_nodes);
    visit("shifted_nodes", r.shifted_nodes);
    visit("paired_nodes", r.paired_nodes);
    visit("hidden_tips", r.hidden_tips);
}

/// A skeleton for the cage: like the given one, but with branch nodes at the points where the tubes separate.
struct SeparatedSkeleton {
    Skeleton skeleton;           ///< skeleton of the cage
    std::vector<NodeId> source;  ///< per node: the corresponding node of the given skeleton
    std::vector<NodeId> tube;    ///< per node of the given skeleton: the tube that wraps its segment
    /// Roots of one child that replace a root of several, ascending: a tree has no flat base there.
    std::vector<NodeId> round_roots;
    std::vector<NodeJoin> joins;  ///< the given ones, of the new nodes, by `end`
    SeparationReport report;      ///< counts of the changes
};

/// A branch that leaves at an acute angle is inside its leader for some distance: two tubes that began at the
/// branch node would cross each other there. So each branch is moved along its leader to the node after which
/// it separates; nodes inside the union around a branch node are merged into it; and each branch node is
/// shifted towards its farthest crotch; a root stays, and a new node gets its branches. Topology changes, but
/// every visible tip is kept, and the surface is projected onto the field of the given skeleton. O(n k) for
/// at most k children at a node.
///
/// `joins` (by `end`) identify tips that end in a node of another branch: there they are laterals like
/// others.
SeparatedSkeleton separate_branches(const Skeleton& skeleton, std::span<const NodeJoin> joins,
                                    const Context& ctx);

}  // namespace coppice
