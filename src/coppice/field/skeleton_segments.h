#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/field/kernel/kernel_constants.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Makes the segments of a convolution field, also where nodes have moved from where the skeleton has them.
class SkeletonSegments {
  public:
    /// Nodes are where the skeleton has them. It must outlive this. O(n).
    SkeletonSegments(const Skeleton& skeleton, const SegmentBuilder& builder);

    /// Tells of nodes that moved: ascending, each with all that hangs on it. `positions` are those of all
    /// nodes. O(moved).
    void follow(std::span<const std::uint32_t> moved, std::span<const Vec3> positions);

    /// What the kernels see of the segment that ends at a node. A root has a ball, of weight 0 where anything
    /// hangs on it. `positions` are those of all nodes, as they were told of last. Thread safe.
    kernel::SegmentConstants<float> build(NodeId n, std::span<const Vec3> positions) const;

  private:
    void find_direction(NodeId n, std::span<const Vec3> positions);

    const Skeleton* skeleton_;
    SegmentBuilder builder_;
    // Where a segment without length points to: as the nearest ancestor that has a length, else to +Z.
    std::vector<Vec3> direction_;
};

}  // namespace coppice
