#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/skeleton/skeleton.h"

/// The axes of a skeleton as tables of branches, and the volume of timber.
namespace coppice {

/// An axis: from a root, or from a child that does not continue the axis of its parent, to a tip.
struct Branch {
    NodeId first;                     ///< a root, or the first node of a lateral
    std::uint32_t tree = 0;           ///< number of the tree in the order of the roots, from 0
    std::uint32_t order = 0;          ///< order by axis_orders(), or as specified
    std::uint32_t parent = kNoIndex;  ///< parent branch; kNoIndex for a stem
    std::uint32_t segments = 0;       ///< number of segments; 0 for a tree of a single node
    double diameter = 0;              ///< [m] at its beginning
    double length = 0;                ///< [m] along its segments
    double area = 0;                  ///< [m^2] lateral area of the cones of its segments
    double volume = 0;                ///< [m^3] of these cones
    double height = 0;                ///< [m] of its base above the root of the tree
    double angle = 0;                 ///< [rad] to the parent branch at its base; 0 for stems
    double azimuth = 0;  ///< [rad] of its direction at the base, from +x towards +y, in (-pi, pi]
    double zenith = 0;   ///< [rad] of its direction at the base from vertical, in [0, pi]

    bool is_stem() const { return parent == kNoIndex; }  ///< whether it begins at a root
};

/// All branches, and the branch of each segment.
struct BranchTable {
    std::vector<Branch> branches;          ///< parents before their laterals
    std::vector<std::uint32_t> branch_of;  ///< by node: branch of its segment
    std::vector<std::uint32_t>
        position_of;              ///< by node: number of its segment in the branch, from 1; 0 for roots
    std::vector<NodeId> next_of;  ///< by node: next node of its branch; none at its end
};

/// Lists the branches of a skeleton; as in branch_orders(), the thickest child continues an axis. Directions
/// at the base of a lateral are those of chords: for the lateral, from its branching node to its first node
/// at a distance of at least two radii of the parent (or its tip); for the parent, along the segment that
/// ends at the branching node. O(n).
BranchTable list_branches(const Skeleton& skeleton);

/// Lists the branches for given orders and axes, as in branch_orders(). O(n).
BranchTable list_branches(const Skeleton& skeleton, std::span<const std::uint32_t> order,
                          std::span<const std::uint32_t> axis);

/// Volumes of a tree with at least a minimum diameter.
struct TimberVolume {
    double stem_length = 0;  ///< [m] of the stem, from the stump to the last position with that diameter
    double stem_volume = 0;  ///< [m^3] of that part of the stem
    double volume = 0;       ///< [m^3] of all parts with that diameter, without the stump
};

/// Returns for each tree, in the order of the roots, the volumes of the cones of its segments with a diameter
/// of at least `top_diameter` [m] > 0. The stem is the branch at the root, cut at `stump_height` [m] >= 0
/// above the root. Thinner sections below its last position with that diameter do not end it. `table` is the
/// result of list_branches(). Throws InvalidInput for numbers that are out of range. O(n).
std::vector<TimberVolume> timber_volumes(const Skeleton& skeleton, const BranchTable& table,
                                         double top_diameter, double stump_height = 0);

}  // namespace coppice
