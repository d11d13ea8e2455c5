#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/node_join.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// End of a section of a branch that enters another branch.
enum class SectionEnd {
    closed,  ///< it ends at the bark
    joined,  ///< it ends in a node of the other branch, and both are one body
};

/// Counts of the changes by grafting.
struct GraftReport {
    std::uint32_t grafted = 0;       ///< sections of branches that begin where they leave another branch
    std::uint32_t truncated = 0;     ///< sections that end where they enter another branch
    std::uint32_t merged = 0;        ///< sections that end in a node of another branch
    std::uint32_t nodes_inside = 0;  ///< nodes inside other branches
    std::uint32_t joined = 0;        ///< trees that begin inside others, and become their branches
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const GraftReport& r, Visitor&& visit) {
    visit("grafted", r.grafted);
    visit("truncated", r.truncated);
    visit("merged", r.merged);
    visit("nodes_inside", r.nodes_inside);
    visit("trees_joined", r.joined);
}

/// A skeleton, and the tree of tubes that wrap it.
struct GraftResult {
    Skeleton skeleton;            ///< the given one, with nodes inserted where sections begin and end
    Skeleton tubes;               ///< the visible sections
    std::vector<NodeId> segment;  ///< per node of `skeleton`: the node of the given one of its segment
    std::vector<NodeId> source;   ///< per node of `tubes`: the corresponding node of `skeleton`
    std::vector<NodeId> tube;     ///< per node of `skeleton`: the node of `tubes` with the tube that contains
                                  ///< its segment; none for a short distance where a section ends at the bark
    std::vector<NodeJoin> joins;  ///< of nodes of `tubes`, by `end`
    GraftReport report;           ///< counts of the changes
};

/// Lets every branch begin where it leaves the others. A branch needs no tube where its axis runs inside
/// another one, and must not have one: two crossing tubes have no closed surface of sphere type without
/// self-intersections. So axes get their tubes in order, thick before thin, each after the one at which it
/// begins; sections inside earlier axes get no tube, and each visible section begins at the branch that it
/// leaves, as if grafted there. A section that enters another branch ends at its bark, or, if it is joined,
/// in a node of the other branch, to which its tube is extended as for a lateral: a section that returns to
/// its own tree then makes a loop, a handle of the surface.
///
/// An axis is inside another one while it is closer than the greater of that one's radius and `depth` times
/// the sum of both radii; depth 0 changes no branch. Branches of two trees are grafted like those of one: a
/// section that leaves another tree begins there, and a tree with its root inside another tree becomes a
/// branch of it. Radii and positions of branches do not change; laterals that leave their own parent in the
/// regular way are unchanged. O(n log n) for the search unless most boxes of segments overlap.
GraftResult graft_branches(const Skeleton& skeleton, float depth, SectionEnd end, const Context& ctx);

}  // namespace coppice
