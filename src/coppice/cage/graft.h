#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/node_join.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// What becomes of a piece of a branch that enters another branch.
enum class PieceEnd {
    closed,  ///< it ends at the bark
    joined,  ///< it ends in a node of the other branch, and both are one body
};

/// What grafting changed, counted.
struct GraftReport {
    std::uint32_t grafted = 0;  ///< pieces of branches that spring from where they leave another branch
    std::uint32_t cut = 0;      ///< pieces that end where they enter another branch
    std::uint32_t merged = 0;   ///< pieces that end in a node of another branch
    std::uint32_t buried = 0;   ///< nodes inside other branches
    std::uint32_t joined = 0;   ///< trees that begin inside others, and are branches of those
};

/// A skeleton, and the tree of tubes that shall wrap it.
struct GraftResult {
    Skeleton skeleton;            ///< the given one, with nodes added where pieces begin and end
    Skeleton tubes;               ///< the pieces that show
    std::vector<NodeId> segment;  ///< per node of `skeleton`: that of the given one on whose segment it lies
    std::vector<NodeId> source;   ///< per node of `tubes`: the node of `skeleton` that it stands for
    std::vector<NodeId> tube;  ///< per node of `skeleton`: the node of `tubes` whose tube holds its segment;
                               ///< none for a little where a piece ends at the bark
    std::vector<NodeJoin> joins;  ///< of nodes of `tubes`, by `end`
    GraftReport report;           ///< what was done
};

/// Lets every branch begin where it leaves the others. A branch whose axis runs inside another one needs no
/// tube there, and must not have one: two tubes that cross have no closed surface of sphere type without
/// self-intersections. So axes get their tubes one by one, thick before thin, each after the one it springs
/// from; what lies inside those that have theirs is left to them, and each piece that shows springs from
/// the branch it leaves, as if grafted there. A piece that enters another branch ends at its bark, or, where
/// it is to be joined, in a node of the other branch, from which its tube is traced back as that of a lateral
/// is: then one that comes back to its own tree makes a loop, a handle of the surface.
///
/// An axis is inside another one while it is nearer than the greater of that one's radius and `depth` times
/// the sum of both radii; depth 0 changes nothing. Branches of two trees are grafted as those of one are:
/// what comes out of another tree springs from there, and a tree whose root lies in another's wood is a
/// branch of that. Radii and the places of branches stay; laterals that leave their own trunk in the ordinary
/// way are not touched. O(n log n) for the search unless most boxes of segments overlap.
GraftResult graft_branches(const Skeleton& skeleton, float depth, PieceEnd end, const Context& ctx);

}  // namespace coppice
