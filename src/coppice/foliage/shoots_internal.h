#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "coppice/foliage/placement.h"
#include "coppice/skeleton/branches.h"

namespace coppice::foliage_internal {

/// The leafy end of an axis.
struct Shoot {
    std::uint32_t branch = 0;  ///< index of its axis
    float length = 0;          ///< [m] from the tip to the last place for leaves
    std::uint32_t nodes = 0;   ///< number of places with leaves
    std::size_t first = 0;     ///< index of its first leaf among all possible leaves
};

/// The shoots of a skeleton.
struct ShootTable {
    BranchTable table;             ///< all axes
    std::vector<Shoot> shoots;     ///< by branch
    float max_radius = 0;          ///< [m] of shoots
    std::uint64_t thick_tips = 0;  ///< as in FoliageReport
    std::size_t leaf_count = 0;    ///< possible leaves: of all places, before any is removed
};

/// A place on the axis of a shoot.
struct ShootPlace {
    Vec3 center;         ///< [m] on the axis
    Vec3 axis;           ///< unit vector towards the tip
    Vec3 normal;         ///< unit vector across, carried along the axis with minimal rotation
    float radius = 0;    ///< [m]
    float from_tip = 0;  ///< 0 at the tip, 1 at the base of the shoot
    NodeId node;         ///< end of its segment
};

/// Finds the shoots with the numbers of their leaves. Throws InvalidInput for too many leaves.
ShootTable find_shoots(const Skeleton& skeleton, const LeafRules& rules);

/// Returns the number of leaves at each node of a shoot.
std::uint32_t count_leaves_per_node(const LeafRules& rules);

/// Returns the places of a shoot, from its tip to its base.
std::vector<ShootPlace> find_places(const Skeleton& skeleton, const ShootTable& table, const Shoot& shoot,
                                    const LeafRules& rules);

}  // namespace coppice::foliage_internal
