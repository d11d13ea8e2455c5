#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/rotation.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Positions, radii and rotations of the nodes of a skeleton at one moment. Nodes and parents are those of
/// the skeleton.
struct Pose {
    std::vector<Vec3> positions;  ///< [m] by node, relative to the skeleton's origin
    std::vector<float> radii;     ///< [m] by node, > 0
    /// By node: rotation of the segment that ends there, including its roll about itself; for a root,
    /// rotation of its ball. Only the roll has to be exact, because directions follow from the positions.
    std::vector<Rotation> turns;

    friend bool operator==(const Pose&, const Pose&) = default;  ///< bitwise equal numbers
};

/// Returns the pose of the unmodified skeleton.
Pose rest_pose(const Skeleton& skeleton);

/// Returns the skeleton in a pose. Throws as the constructor of Skeleton does.
Skeleton posed(const Skeleton& skeleton, const Pose& pose);

/// Interpolates two poses at `part` in [0, 1]. Each segment rotates and scales in its own frame, so that
/// branches keep their lengths. O(n).
Pose on_the_way(const Skeleton& skeleton, const Pose& from, const Pose& to, double part);

/// Returns the pose `wanted` with the frozen nodes fixed: they keep their positions relative to their parents
/// from `last`, and frozen roots keep their positions. Descendants follow rigidly. O(n).
Pose freeze(const Skeleton& skeleton, const Pose& wanted, const Pose& last,
            std::span<const std::uint8_t> is_frozen);

/// Marks all nodes on the path between two nodes as frozen, so that a frozen pose preserves their relative
/// position. If the nodes are in different trees, marks the paths to both roots. O(depth).
void freeze_between(const Skeleton& skeleton, NodeId a, NodeId b, std::span<std::uint8_t> is_frozen);

}  // namespace coppice
