#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/field/kernel/kernel_constants.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Creates the segments of a convolution field, also for moved nodes.
class SkeletonSegments {
  public:
    /// Starts with the node positions of the skeleton, which must outlive the object. O(n).
    SkeletonSegments(const Skeleton& skeleton, const SegmentBuilder& builder);

    /// Updates moved nodes: sorted, each with all its descendants. `positions` are the positions of all
    /// nodes. O(moved).
    void follow(std::span<const std::uint32_t> moved, std::span<const Vec3> positions);

    /// Returns the constants of the segment that ends at a node. A root has a ball, of weight 0 if it has
    /// children. `positions` are the positions of all nodes at the latest update. Thread safe.
    kernel::SegmentConstants<float> build(NodeId n, std::span<const Vec3> positions) const;

  private:
    void find_direction(NodeId n, std::span<const Vec3> positions);

    const Skeleton* skeleton_;
    SegmentBuilder builder_;
    // Direction of a segment without length: as the nearest ancestor with a length, or +Z.
    std::vector<Vec3> direction_;
};

}  // namespace coppice
