#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/rotation.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Where the nodes of a skeleton are at a moment: the same nodes with the same parents, elsewhere.
struct Pose {
    std::vector<Vec3> positions;  ///< [m] by node, relative to the skeleton's origin
    std::vector<float> radii;     ///< [m] by node, > 0
    /// By node: how the segment that ends there has turned, its roll about itself included; of a root, its
    /// ball. Only the roll has to be right: directions follow from the positions.
    std::vector<Rotation> turns;

    friend bool operator==(const Pose&, const Pose&) = default;  ///< the same numbers
};

/// The skeleton as it stands.
Pose rest_pose(const Skeleton& skeleton);

/// The skeleton in a pose. Throws what Skeleton throws.
Skeleton posed(const Skeleton& skeleton, const Pose& pose);

/// Part of the way from one pose to another, at `part` in [0, 1]: every segment turns and grows with respect
/// to nothing but itself, so that branches keep their lengths. O(n).
Pose on_the_way(const Skeleton& skeleton, const Pose& from, const Pose& to, double part);

/// What is wanted, but for nodes that are held: these stand to their parents as in `last`, roots where they
/// were; all that hangs on them goes along. O(n).
Pose held(const Skeleton& skeleton, const Pose& wanted, const Pose& last,
          std::span<const std::uint8_t> is_held);

/// Marks as held all nodes on the way between two of them, so that in a held pose these stand to each other
/// as they did before; in different trees on the ways to both roots. O(depth).
void hold_between(const Skeleton& skeleton, NodeId a, NodeId b, std::span<std::uint8_t> is_held);

}  // namespace coppice
