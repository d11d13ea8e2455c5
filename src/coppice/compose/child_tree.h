#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A branch with all that it carries, taken out of a tree [Zhu2015, figure 18], in a frame of its own: the
/// branch node that it left is its root and lies at the origin, it sets off along +z, and the axis of its
/// host goes on towards +x, so that it can be put on another host.
struct ChildTree {
    Skeleton skeleton;      ///< one tree, whose root has one child
    float host_radius = 0;  ///< [m] of the host at the branch node; > 0
    float inclination = 0;  ///< [rad] between its direction and the host's, in [0, pi]
    bool leads = false;     ///< whether it goes on with its host, as the thickest child of the node
    std::uint32_t source_node =
        0;  ///< its first node behind the branch node, in the skeleton that it is from
};

/// What a child tree is like.
struct ChildTreeMeasures {
    double length = 0;         ///< [m] of all segments
    double volume = 0;         ///< [m^3] of the cones between nodes
    double extent = 0;         ///< [m] from the root to the farthest node
    std::uint32_t nodes = 0;   ///< its root counts
    std::uint32_t tips = 0;    ///< nodes without children
    std::uint32_t orders = 0;  ///< 1 without branches, 2 where it has laterals, 3 where these have, ...
    float radius = 0;          ///< [m] at its first node behind the branch node
};

/// O(n).
ChildTreeMeasures measure(const ChildTree& tree);

/// Which branches are taken.
struct ChildTreeOptions {
    bool leaders = true;     ///< those that go on with their host too
    float least_length = 0;  ///< [m] of all their segments
};

template <class Self, class Visitor>
requires SameOptions<Self, ChildTreeOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"leaders", "takes branches that go on with their host too"}, o.leaders);
    visit(Field{"least_length", "takes branches whose segments are together as long as this", Unit::metre, 0,
                1e6},
          o.least_length);
}

/// Every child branch of every branch node, in order of the nodes. Throws InvalidInput when an option is out
/// of its range. Time and memory: of what is taken; a node is taken once for each branch node below it on the
/// way to the root.
std::vector<ChildTree> child_trees(const Skeleton& skeleton, const ChildTreeOptions& options = {},
                                   const Context& ctx = {});

/// Whether a branch begins there: at a child of a node that has several.
bool begins_child_tree(const Skeleton& skeleton, NodeId node);

/// Those that begin at `first` alone: nodes that are children of branch nodes. Throws InvalidInput naming a
/// node that is not.
std::vector<ChildTree> child_trees_at(const Skeleton& skeleton, const std::vector<NodeId>& first);

}  // namespace coppice
