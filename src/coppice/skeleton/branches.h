#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "coppice/skeleton/skeleton.h"

/// The axes of a skeleton one by one, as tables of branches list them, and the volume of timber.
namespace coppice {

/// In place of the index of a branch: a stem leaves no other.
inline constexpr std::uint32_t kNoBranch = std::numeric_limits<std::uint32_t>::max();

/// An axis: from a root, or from a node that a child leaves beside the one that goes on, to a tip.
struct Branch {
    NodeId first;                      ///< a root, or the first node of a lateral
    std::uint32_t tree = 0;            ///< counted in the order of the roots, from 0
    std::uint32_t order = 0;           ///< as axis_orders() has it, or as it is known otherwise
    std::uint32_t parent = kNoBranch;  ///< the branch that it leaves
    std::uint32_t segments = 0;        ///< how many; none where a tree is a single node
    double diameter = 0;               ///< [m] where it begins
    double length = 0;                 ///< [m] along its segments
    double area = 0;                   ///< [m^2] lateral area of their cones
    double volume = 0;                 ///< [m^3] of these
    double height = 0;                 ///< [m] of its base above the root of the tree
    double angle = 0;                  ///< [rad] to the branch that it leaves, there; 0 for stems
    double azimuth = 0;  ///< [rad] of its direction at the base, from +x towards +y, in (-pi, pi]
    double zenith = 0;   ///< [rad] of that from upward, in [0, pi]

    bool is_stem() const { return parent == kNoBranch; }  ///< it begins at a root
};

/// All branches, and where each segment is.
struct BranchTable {
    std::vector<Branch> branches;            ///< parents before those that leave them
    std::vector<std::uint32_t> branch_of;    ///< per node the branch of its segment
    std::vector<std::uint32_t> position_of;  ///< per node which segment of the branch, from 1; 0 for roots
    std::vector<NodeId> next_of;             ///< per node the next one on its branch; none at its end
};

/// Lists the branches of a skeleton, after the thickest child as branch_orders() does. Directions at the base
/// of a lateral are those of chords: of its own from where it leaves the axis of its parent to its first node
/// at least two radii of the parent away (its tip, if none is), and of the segment of the parent that ends
/// there. O(n).
BranchTable list_branches(const Skeleton& skeleton);

/// The same for orders and axes that are known otherwise, as in branch_orders(). O(n).
BranchTable list_branches(const Skeleton& skeleton, std::span<const std::uint32_t> order,
                          std::span<const std::uint32_t> axis);

/// Wood of a tree that has at least a diameter.
struct TimberVolume {
    double stem_length = 0;  ///< [m] of the stem, from the stump to where it is last that thick
    double stem_volume = 0;  ///< [m^3] of that
    double volume = 0;       ///< [m^3] of all that is that thick, without the stump
};

/// Volumes of the cones of the segments of each tree, in the order of the roots, that are at least as thick
/// as a top diameter [m] > 0. The stem is the branch at the root, cut `stump_height` [m] >= 0 above the root.
/// Thinner places below its last one that is as thick do not end it. `table` is that of list_branches().
/// Throws InvalidInput for numbers that are out of range. O(n).
std::vector<TimberVolume> timber_volumes(const Skeleton& skeleton, const BranchTable& table,
                                         double top_diameter, double stump_height = 0);

}  // namespace coppice
