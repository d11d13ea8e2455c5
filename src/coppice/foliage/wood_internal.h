#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::foliage_internal {

/// The segments of a skeleton that leaves must not enter.
class Wood {
  public:
    /// Takes the segments with an end thicker than `max_radius` [m].
    Wood(const Skeleton& skeleton, float max_radius, const Context& ctx);

    /// Returns whether any of the points is more than `depth` [m] inside of a segment other than the one that
    /// ends at `except`.
    bool contains_any(std::span<const Vec3> points, NodeId except, float depth) const;

  private:
    std::vector<NodeId> nodes_;
    std::vector<BasicRoundCone<float>> cones_;
    BoxTree boxes_;
};

}  // namespace coppice::foliage_internal
