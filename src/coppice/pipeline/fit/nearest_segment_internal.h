#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// Finds the segment on which a point of a surface is, given the segment of a point nearby: by descent along
/// the skeleton from there, and by the tree if that ends off the surface. Several times faster than the tree
/// alone, and stays on one of two branches that touch.
class NearestSegment {
  public:
    /// The capsules are those of the skeleton's segments, with or without trees of one node. Both must
    /// outlive this object.
    NearestSegment(const Skeleton& skeleton, const CapsuleTree& capsules);

    /// Returns kNoIndex without capsules, or if all are far away.
    std::uint32_t operator()(Vec3d p, std::uint32_t hint) const;

  private:
    std::uint32_t downhill(Vec3d p, std::uint32_t from, double& rho_squared) const;

    const Skeleton& skeleton_;
    const CapsuleTree& capsules_;
    std::vector<std::uint32_t> capsule_of_;  ///< by node
};

}  // namespace coppice::pipeline_internal
