#pragma once

#include <cstdint>
#include <vector>

#include "coppice/measure/capsule_tree.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// Finds the segment that a point of a surface lies on, given that of a point nearby: downhill along the
/// skeleton from there, and by the tree where that ends off the surface. Several times faster than the tree
/// alone, and keeps to one of two branches that touch.
class NearestSegment {
  public:
    /// The capsules are those of the skeleton's segments, and of trees of one node or not. Both must outlive
    /// this.
    NearestSegment(const Skeleton& skeleton, const CapsuleTree& capsules);

    /// kNone without capsules, or far from all.
    std::uint32_t operator()(Vec3d p, std::uint32_t hint) const;

  private:
    std::uint32_t downhill(Vec3d p, std::uint32_t from, double& rho_squared) const;

    const Skeleton& skeleton_;
    const CapsuleTree& capsules_;
    std::vector<std::uint32_t> capsule_of_;  ///< by node
};

}  // namespace coppice::pipeline_internal
